#include "csrbf/approx/kriging/grown_variance.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"

#include <limits>

namespace csrbf::grown_variance_test {
namespace {

template <int Dim>
class Constant : public Field<Dim> {
 public:
  explicit Constant(double value) : value_(value) {}
  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override {
    std::fill_n(out.value, x.cols(), value_);
  }
  [[nodiscard]] Box<Dim> bounds() const override { return {Point<Dim>::Zero(), Point<Dim>::Ones()}; }

 private:
  double value_;
};

TEST(GrowthWithDistance, IsAPowerFromWhereDistancesAreUsual) {
  const GrowthWithDistance growth{2, 3};
  for (const double d : {1.0, 1.5, 4.0}) EXPECT_NEAR(growth.factor(d), 2 * d * d * d, 1e-12 * d * d * d);
  for (const double d : {0.0, .3, .8}) EXPECT_EQ(growth.factor(d), 1);
}

TEST(GrowthWithDistance, NeverShrinksNorJumpsNorIsInfinite) {
  for (const GrowthWithDistance growth : {GrowthWithDistance{2, 3}, {.01, 6}, {1, 0}, {0, 2}, {30, 16}}) {
    double before = 1;
    for (double d = 0; d < 3; d += 1e-3) {
      const double factor = growth.factor(d);
      EXPECT_GE(factor, before * (1 - 1e-12)) << d;
      EXPECT_LE(factor, 1.06 * before) << d;
      before = factor;
    }
    EXPECT_LE(growth.factor(std::numeric_limits<double>::infinity()), 1e12);
  }
}

TEST(GrownVariance, GrowsWithTheDistanceToTheNearestSample) {
  Points<2> samples(2, 2);
  samples << 0, 1, 0, 0;
  const GrownVariance<2> grown(std::make_shared<const Constant<2>>(5), std::make_shared<const Constant<2>>(.1),
                               std::make_shared<const SamplePlaces<2>>(samples), {1, 2});
  Points<2> x(2, 4);
  x << 0, .9, .3, 1,  //
      0, .05, 0, 2;
  const Eigen::VectorXd value = grown.evaluate(x).value;
  EXPECT_EQ(value[0], 5);
  EXPECT_NEAR(value[1], 5 * 1.25, 1e-12);
  EXPECT_NEAR(value[2], 5 * 9, 1e-12);
  EXPECT_NEAR(value[3], 5 * 400, 1e-9);
  EXPECT_TRUE(grown.evaluate(x, Derivatives::gradient).gradient.array().isNaN().all());
}

// A season with a trend, and some quarters without samples.
TEST(GrownVariance, IsThatOfPatchesOfFewSamples) {
  Points<1> x(1, 60), gap(1, 1), usual(1, 1);
  for (Index i = 0; i < 60; ++i) x(0, i) = static_cast<double>(i < 40 ? i : i + 9);
  gap << 44;
  usual << 20.5;
  const auto season = [](const Point<1>& p) { return std::sin(1.5 * p[0]) * (1 + p[0] / 50) + std::cos(p[0] * p[0]); };
  const Fit<1> found = fit<1>(sample<1>(x, season), {.method = "partition-of-unity"});
  const Field<1>& variance = *found.variances[0];
  EXPECT_GT(variance.evaluate(gap).value[0], 4 * variance.evaluate(usual).value[0]);
}

}  // namespace
}  // namespace csrbf::grown_variance_test
