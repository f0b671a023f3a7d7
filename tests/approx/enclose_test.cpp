#include "csrbf/approx/fit.hpp"
#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/approx/samples/fitted_field.hpp"
#include "implicit/analytic_fields.hpp"

#include <gtest/gtest.h>

namespace csrbf::enclose_test {
namespace {

const Box<3> around = box_around(Point<3>::Zero(), Point<3>::Constant(1.2));

std::shared_ptr<const Expansion<3>> expansion(const std::string& kernel, double support, int degree) {
  const Points<3> centers = random_points_in(box_around(Point<3>::Zero(), Point<3>::Ones()), 60, 1);
  PolynomialTail<3> tail;
  tail.degree = degree;
  tail.scale = 2;
  tail.coefficients =
      Eigen::VectorXd::LinSpaced(degree < 0 ? 0 : (degree + 1) * (degree + 2) * (degree + 3) / 6, -1, 2);
  const Eigen::VectorXd coefficients = random_points_in(around, 20, 2).reshaped();
  return make_expansion<3>(Kernel(kernel, 3), centers, Eigen::VectorXd::LinSpaced(60, 0.5 * support, support),
                           coefficients, tail);
}

TEST(Enclose, HoldsForExpansions) {
  for (const std::string kernel : {"wendland-c2", "wendland-c4", "wendland-c6"})
    for (const int degree : {-1, 0, 1, 2})
      EXPECT_TRUE(encloses(*expansion(kernel, 0.8, degree), around, 3)) << kernel << " " << degree;
}

TEST(Enclose, HoldsForSumsOfLevels) {
  EXPECT_TRUE(encloses(LevelSum<3>({expansion("wendland-c4", 1.5, 1), expansion("wendland-c4", 0.4, -1)}), around, 4));
}

TEST(Enclose, HoldsForFittedFunctionsInsideAndOutsideTheirBox) {
  FittedField<3>::Frame frame;
  frame.scales = Point<3>(1, 0.5, 2);
  frame.box = box_around(Point<3>::Zero(), Point<3>(1, 0.5, 2));
  const FittedField<3> fitted(expansion("wendland-c4", 0.8, 1), frame);
  EXPECT_TRUE(encloses(fitted, frame.box, 5));
  EXPECT_TRUE(encloses(fitted, frame.box.inflated(1), 6));
}

TEST(Enclose, TightensAsTheSquareOfTheBox) {
  const auto field = expansion("wendland-c4", 0.8, 1);
  const Point<3> p(0.1, 0.2, -0.3);
  const double slope = field->evaluate(p, Derivatives::gradient).gradient.col(0).norm();
  for (const double half : {0.01, 0.001}) {
    const Enclosure e = field->enclose(box_around(p, Point<3>::Constant(half))).value();
    const double r = std::sqrt(3) * half;
    EXPECT_LE(0.5 * (e.hi - e.lo), slope * r + e.hessian_bound * r * r);
    EXPECT_LE(e.lipschitz, (slope + e.hessian_bound * r) * (1 + 1e-12));
  }
}

TEST(Enclose, IsNotClaimedWhereNothingIsKnown) {
  EXPECT_FALSE(expansion("wendland-c0", 0.8, 1)->enclose(around).has_value());
  EXPECT_FALSE(expansion("gaussian", 0.8, 1)->enclose(around).has_value());
  EXPECT_FALSE(expansion("wendland-c2", 0.8, 3)->enclose(around).has_value());
  FittedField<3>::Frame frame;
  frame.box = around;
  frame.periods[1] = 3;
  EXPECT_FALSE(FittedField<3>(expansion("wendland-c4", 0.8, 1), frame).enclose(around).has_value());
}

}  // namespace
}  // namespace csrbf::enclose_test
