#include "csrbf/approx/samples/periodic_field.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"

#include <numbers>

namespace csrbf::periodic_field_test {
namespace {

constexpr double period = 2.5, lo = -.75;
constexpr double rounding = 1e-14;  // of values and derivatives of size 1 to 10

// sin(a x + y) y with its derivatives, of which period 2 pi / a along x.
class Wave : public Field<2> {
 public:
  explicit Wave(double a) : a_(a) {}
  void evaluate_block(const PointsRef<2>& x, const JetBlock& out) const override {
    for (Index i = 0; i < x.cols(); ++i) {
      const double y = x(1, i), s = std::sin(a_ * x(0, i) + y), c = std::cos(a_ * x(0, i) + y);
      out.value[i] = s * y;
      if (out.gradient != nullptr) {
        out.gradient[2 * i] = a_ * c * y;
        out.gradient[2 * i + 1] = c * y + s;
      }
      if (out.hessian != nullptr) {
        out.hessian[3 * i] = -a_ * a_ * s * y;
        out.hessian[3 * i + 1] = a_ * (c - s * y);
        out.hessian[3 * i + 2] = 2 * c - s * y;
      }
    }
  }
  [[nodiscard]] Box<2> bounds() const override { return {Point<2>(-5, -5), Point<2>(5, 5)}; }

 private:
  double a_;
};

std::shared_ptr<const Field<2>> repeated(double a, int axis = 0) {
  return std::make_shared<PeriodicField<2>>(std::make_shared<Wave>(a), axis, lo, period);
}

TEST(PeriodicField, IsAsSmoothAtTheSeamAsElsewhere) {
  const auto f = repeated(1);  // of another period: the two sides of the seam have nothing in common
  for (const double turn : {0.0, 4 * period})
    for (const double y : {-.8, .3, 1.0}) {
      Points<2> x(2, 2);
      x << std::nextafter(lo + turn, -9), lo + turn, y, y;
      const Jet<2> jet = f->evaluate(x, Derivatives::hessian);
      EXPECT_NEAR(jet.value[0], jet.value[1], rounding);
      EXPECT_LE((jet.gradient.col(0) - jet.gradient.col(1)).norm(), rounding);
      EXPECT_LE((jet.hessian.col(0) - jet.hessian.col(1)).norm(), rounding);
    }
  Points<2> x = random_points<2>(300, 1);
  x.row(0) = (lo + 1.2 * PeriodicField<2>::seam_share * period * x.row(0).array()).matrix();
  expect_true_derivatives<2>(*f, x, 1e-5, 1e-4);  // central differences where the two sides blend: f''' is about 1e4
}

TEST(PeriodicField, RepeatsItself) {
  const auto f = repeated(1);
  const Points<2> x = random_points<2>(100, 1);
  for (const double turns : {-7.0, 1.0, 12.0}) {
    const Points<2> other = x.colwise() + Point<2>(turns * period, 0);
    EXPECT_LE((f->evaluate(other).value - f->evaluate(x).value).cwiseAbs().maxCoeff(), 100 * rounding);
  }
  EXPECT_EQ(f->bounds().lo, Point<2>(lo, -5));
  EXPECT_EQ(f->bounds().hi, Point<2>(lo + period, 5));
}

TEST(PeriodicField, OfAPeriodicFieldIsThatField) {
  const Wave wave(2 * std::numbers::pi / period);
  const auto f = repeated(2 * std::numbers::pi / period);
  const Points<2> x = (10 * random_points<2>(500, 1).array() - 5).matrix();
  const Jet<2> found = f->evaluate(x, Derivatives::hessian), truth = wave.evaluate(x, Derivatives::hessian);
  EXPECT_LE((found.value - truth.value).cwiseAbs().maxCoeff(), 10 * rounding);
  EXPECT_LE((found.gradient - truth.gradient).cwiseAbs().maxCoeff(), 100 * rounding);
  EXPECT_LE((found.hessian - truth.hessian).cwiseAbs().maxCoeff(), 1e4 * rounding);  // s'' is about 500
}

TEST(PeriodicField, IsTheInnerFieldAwayFromTheSeam) {
  const auto f = repeated(1);
  const Wave wave(1);
  for (const double share : {PeriodicField<2>::seam_share, .3, .9}) {
    const Point<2> x(lo + 1.0001 * share * period, .4);
    EXPECT_EQ((*f)(x), wave(x));
  }
}

TEST(PeriodicField, MayRepeatAlongSeveralAxes) {
  const PeriodicField<2> f(repeated(1), 1, 0, 3);
  const Points<2> x = (random_points<2>(200, 1).array() * .2 - .1).matrix();  // around the corner of the first period
  expect_true_derivatives<2>(f, x.colwise() + Point<2>(lo, 0), 1e-5, 1e-3);
  EXPECT_NEAR(f(Point<2>(lo + .1, .05)), f(Point<2>(lo + .1 - 2 * period, .05 + 9)), 100 * rounding);
}

TEST(PeriodicField, IsUndefinedAtUndefinedPoints) {
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    EXPECT_TRUE(std::isnan((*repeated(1))(Point<2>(bad, 1))));
    EXPECT_TRUE(std::isnan((*repeated(1))(Point<2>(lo, std::nan("")))));
  }
}

TEST(RepeatPeriodically, WrapsSamplesAndCopiesThoseNearTheEnds) {
  Samples<2> samples{Points<2>(2, 4), Eigen::Vector4d(1, 2, 3, 4), Eigen::Vector4d(4, 3, 2, 1)};
  samples.points << 0, 359, 180, -10 + 720, 0, 1, 2, 3;
  const Samples<2> repeated = repeat_periodically<2>(samples, Point<2>(360, 0), Point<2>(0, 0));
  ASSERT_EQ(repeated.size(), 7);  // all but the one at 180 degrees have a copy
  EXPECT_EQ(repeated.points.row(0), (Eigen::RowVectorXd(7) << 0, 359, 180, 350, 360, -1, -10).finished());
  EXPECT_EQ(repeated.points.row(1), (Eigen::RowVectorXd(7) << 0, 1, 2, 3, 0, 1, 3).finished());
  EXPECT_EQ(repeated.values.col(0), (Eigen::VectorXd(7) << 1, 2, 3, 4, 1, 2, 4).finished());
  EXPECT_EQ(repeated.weights, (Eigen::VectorXd(7) << 4, 3, 2, 1, 4, 3, 1).finished());
}

TEST(RepeatPeriodically, BringsSamplesAtOnePlaceTogether) {
  constexpr Index n = 2000;
  Samples<2> samples{random_points<2>(n, 1), Eigen::VectorXd::Zero(n), {}};
  samples.points.row(0) *= 360;
  for (Index i = 0; i < n / 2; ++i)
    samples.points.col(n / 2 + i) = samples.points.col(i) + Point<2>(360 * static_cast<double>(i % 9 - 4), 0);
  samples.points.col(0) << 0, .5;  // the seam itself, from both sides
  samples.points.col(n / 2) << 360 * (1 - 1e-16), .5;
  for (const double west : {0.0, -180.0, 77.7}) {
    const Samples<2> repeated = repeat_periodically<2>(samples, Point<2>(360, 0), Point<2>(west, 0));
    const auto place = merge_duplicates(repeated).place;
    EXPECT_EQ(*std::max_element(place.begin(), place.begin() + n), n / 2 - 1) << west;
  }
}

}  // namespace
}  // namespace csrbf::periodic_field_test
