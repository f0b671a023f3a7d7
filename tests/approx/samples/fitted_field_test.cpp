#include "csrbf/approx/samples/fitted_field.hpp"

#include "approx/approx_testing.hpp"

#include <numeric>

namespace csrbf::fitted_field_test {
namespace {

// y0^2 y1 + 3 y1 with all derivatives; remembers nothing and orders points backwards.
class Cubic : public Field<2> {
 public:
  void evaluate_block(const PointsRef<2>& y, const JetBlock& out) const override {
    for (Index i = 0; i < y.cols(); ++i) {
      const double u = y(0, i), v = y(1, i);
      out.value[i] = u * u * v + 3 * v;
      if (out.gradient != nullptr) {
        out.gradient[2 * i] = 2 * u * v;
        out.gradient[2 * i + 1] = u * u + 3;
      }
      if (out.hessian != nullptr) {
        out.hessian[3 * i] = 2 * v;
        out.hessian[3 * i + 1] = 2 * u;
        out.hessian[3 * i + 2] = 0;
      }
    }
  }
  [[nodiscard]] Box<2> bounds() const override { return {Point<2>(-9, -9), Point<2>(9, 9)}; }
  [[nodiscard]] double feature_size() const override { return .5; }
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<2>& y) const override {
    std::vector<Index> order(y.cols());
    std::iota(order.rbegin(), order.rend(), Index{0});
    return order;
  }
};

FittedField<2> field(const FittedField<2>::Frame& frame) {
  return FittedField<2>(std::make_shared<Cubic>(), frame);
}

const Box<2> box{Point<2>(-1, 10), Point<2>(3, 30)};

TEST(FittedField, DividesCoordinatesByTheirScales) {
  const FittedField<2> f = field({.scales = Point<2>(2, 10), .box = box});
  const Point<2> x(1, 20);  // y = (.5, 2)
  const Jet<2> jet = f.evaluate(x, Derivatives::hessian);
  EXPECT_DOUBLE_EQ(jet.value[0], .5 * .5 * 2 + 6);
  EXPECT_DOUBLE_EQ(jet.gradient(0, 0), 2 * .5 * 2 / 2);
  EXPECT_DOUBLE_EQ(jet.gradient(1, 0), (.25 + 3) / 10);
  EXPECT_DOUBLE_EQ(jet.hessian(0, 0), 2 * 2 / 4.0);
  EXPECT_DOUBLE_EQ(jet.hessian(1, 0), 2 * .5 / 20);
  EXPECT_EQ(jet.hessian(2, 0), 0);
  EXPECT_EQ(f.feature_size(), 1);
  EXPECT_EQ(f.bounds().lo, box.lo);
}

TEST(FittedField, ContinuesLinearlyOrAsItIs) {
  const FittedField<2> linear = field({.scales = Point<2>(2, 10), .box = box, .extrapolation = Extrapolation::linear});
  const Point<2> corner(3, 30), x(5, 50);
  const Jet<2> at = linear.evaluate(corner, Derivatives::hessian), beyond = linear.evaluate(x, Derivatives::hessian);
  EXPECT_DOUBLE_EQ(beyond.value[0], at.value[0] + at.gradient.col(0).dot(x - corner));
  EXPECT_DOUBLE_EQ(beyond.gradient(0, 0), at.gradient(0, 0));
  EXPECT_EQ(beyond.hessian(0, 0), 0);
  const Points<2> places = (random_points<2>(50, 1).array() * 60 - 15).matrix();
  const Jet<2> jet = linear.evaluate(places, Derivatives::gradient);
  for (int a = 0; a < 2; ++a) {
    const Points<2> ahead = places.colwise() + 1e-5 * Point<2>::Unit(a),
                    behind = places.colwise() - 1e-5 * Point<2>::Unit(a);
    const Eigen::VectorXd slope = (linear.evaluate(ahead).value - linear.evaluate(behind).value) / 2e-5;
    EXPECT_LE((jet.gradient.row(a).transpose() - slope).cwiseAbs().maxCoeff(), 1e-6);
  }
  const FittedField<2> trend = field({.scales = Point<2>(2, 10), .box = box, .extrapolation = Extrapolation::trend});
  EXPECT_DOUBLE_EQ(trend(x), 2.5 * 2.5 * 5 + 15);
  EXPECT_DOUBLE_EQ(trend(Point<2>(1, 20)), linear(Point<2>(1, 20)));
}

TEST(FittedField, FollowsTheSlopeUpToItsRim) {
  const FittedField<2> linear = field({.scales = Point<2>(2, 10), .box = box, .extrapolation = Extrapolation::linear});
  const FittedField<2> f = field({.scales = Point<2>(2, 10), .box = box, .rim = Point<2>(.5, 0)});
  EXPECT_EQ(f(Point<2>(3.4, 20)), linear(Point<2>(3.4, 20)));
  EXPECT_EQ(f(Point<2>(-1.4, 20)), linear(Point<2>(-1.4, 20)));
  EXPECT_EQ(f(Point<2>(7, 20)), linear(Point<2>(3.5, 20)));
  EXPECT_EQ(f(Point<2>(1, 40)), linear(Point<2>(1, 30)));
  const Points<2> x = (random_points<2>(50, 1).array() * 60 - 15).matrix();
  expect_true_derivatives<2>(f, x, 1e-5, 1e-7);
  EXPECT_EQ(f.in_units(Point<2>(3, 1), 1)->frame().rim, Point<2>(1.5, 0));
}

TEST(FittedField, GrowsOutsideTheBox) {
  const FittedField<2> f = field({.scales = Point<2>(2, 10), .box = box, .growth = {.5, 2, 4}});
  const FittedField<2> constant = field({.scales = Point<2>(2, 10), .box = box});
  EXPECT_EQ(f(Point<2>(1, 20)), constant(Point<2>(1, 20)));
  EXPECT_DOUBLE_EQ(f(Point<2>(5, 20)), constant(Point<2>(5, 20)) + .5);
  EXPECT_DOUBLE_EQ(f(Point<2>(5, 40)), constant(Point<2>(5, 40)) + 1);
  EXPECT_DOUBLE_EQ(f(Point<2>(50, 40)), constant(Point<2>(50, 40)) + 4);
}

TEST(FittedField, HasTrueDerivativesInsideAndOutsideTheBox) {
  const FittedField<2> f = field({.scales = Point<2>(2, 10), .box = box});
  Points<2> x = (random_points<2>(50, 1).array() * 60 - 15).matrix();
  expect_true_derivatives<2>(f, x, 1e-5, 1e-7);
}

TEST(FittedField, IsTheValueAtTheNearestPointOfTheBoxOutside) {
  const FittedField<2> f = field({.box = box});
  const Point<2> x(7, 20);
  const Jet<2> jet = f.evaluate(x, Derivatives::hessian), edge = f.evaluate(Point<2>(3, 20), Derivatives::hessian);
  EXPECT_EQ(jet.value, edge.value);
  EXPECT_EQ(jet.gradient(0, 0), 0);
  EXPECT_EQ(jet.gradient(1, 0), edge.gradient(1, 0));
  EXPECT_EQ(jet.hessian(0, 0), 0);
  EXPECT_EQ(jet.hessian(1, 0), 0);
  EXPECT_NE(edge.hessian(1, 0), 0);
}

TEST(FittedField, IsUndefinedOutsideOnDemand) {
  const FittedField<2> f = field({.box = box, .extrapolation = Extrapolation::nan});
  for (const Point<2>& x : {Point<2>(3.001, 20), Point<2>(0, 9.999), Point<2>(-1e300, 1e300)}) {
    const Jet<2> jet = f.evaluate(x, Derivatives::hessian);
    EXPECT_TRUE(std::isnan(jet.value[0]));
    EXPECT_TRUE(jet.gradient.array().isNaN().all());
    EXPECT_TRUE(jet.hessian.array().isNaN().all());
  }
  for (const Point<2>& corner : {box.lo, box.hi}) EXPECT_EQ(f(corner), field({.box = box})(corner));
}

TEST(FittedField, IsUndefinedAtPointsThatAreNotFinite) {
  for (const Extrapolation extrapolation : {Extrapolation::constant, Extrapolation::nan})
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
      const FittedField<2> f = field({.periods = Point<2>(4, 0), .box = box, .extrapolation = extrapolation});
      EXPECT_TRUE(std::isnan(f(Point<2>(bad, 20))));
      EXPECT_TRUE(std::isnan(f(Point<2>(0, bad))));
      EXPECT_TRUE(f.evaluate(Point<2>(0, bad), Derivatives::gradient).gradient.array().isNaN().all());
    }
}

TEST(FittedField, WrapsPeriodicCoordinates) {
  const FittedField<2> f =
      field({.periods = Point<2>(8, 0), .box = box, .extrapolation = Extrapolation::nan});  // x from -1 to 7
  for (const double turn : {-80.0, -8.0, 8.0, 1600.0}) {
    EXPECT_EQ(f(Point<2>(2 + turn, 20)), f(Point<2>(2, 20)));
    EXPECT_EQ(f(Point<2>(5 + turn, 20)), f(Point<2>(5, 20)));  // beyond the samples, but no place is outside
    EXPECT_EQ(f(Point<2>(-1 + turn, 20)), f(Point<2>(-1, 20)));
  }
  EXPECT_EQ(f(Point<2>(5, 20)), 25 * 20 + 60);
  EXPECT_EQ(f.evaluate(Point<2>(13, 20), Derivatives::gradient).gradient(0, 0), 2 * 5 * 20);
  EXPECT_TRUE(std::isnan(f(Point<2>(5, 31))));
}

TEST(FittedField, EvaluatesInTheOrderOfTheInnerField) {
  const FittedField<2> f = field({.scales = Point<2>(2, 10), .box = box});
  const Points<2> x = (random_points<2>(2000, 1) * 40).eval();
  EXPECT_EQ(f.evaluation_order(x).front(), 1999);
  const Jet<2> jet = f.evaluate(x, Derivatives::hessian);
  for (Index i = 0; i < x.cols(); ++i) {
    const Jet<2> single = f.evaluate(x.col(i), Derivatives::hessian);
    EXPECT_EQ(jet.value[i], single.value[0]);
    EXPECT_EQ(jet.gradient.col(i), single.gradient.col(0));
    EXPECT_EQ(jet.hessian.col(i), single.hessian.col(0));
  }
}

}  // namespace
}  // namespace csrbf::fitted_field_test
