#include "csrbf/approx/left_out/left_out_folds.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"
#include "csrbf/core/error.hpp"

namespace csrbf::left_out_folds_test {
namespace {

class Constant : public Field<2> {
 public:
  explicit Constant(double value) : value_(value) {}
  void evaluate_block(const PointsRef<2>& x, const JetBlock& out) const override {
    std::fill_n(out.value, x.cols(), value_);
  }
  [[nodiscard]] Box<2> bounds() const override { return {Point<2>(0, 0), Point<2>(1, 1)}; }

 private:
  double value_;
};

// Of 46 samples of a constant that a fit takes for 0, with this variance.
double growth_of(double error, double variance) {
  const Samples<2> samples = sample<2>(random_points<2>(46, 1), [&](const Point<2>&) { return error; });
  const auto zero = [&](const Samples<2>& others) {
    EXPECT_GE(others.size(), 36);
    EXPECT_LE(others.size(), 37);
    return FittedParts<2>{{std::make_shared<Constant>(0)}, {std::make_shared<Constant>(variance)}};
  };
  return left_out_folds<2>(samples, zero)[0];
}

TEST(LeftOutFolds, GrowthIsTheMeanSquareOverWhatIsExpected) {
  EXPECT_NEAR(growth_of(3, 1), (4 + 46 * 9) / 50.0, 1e-12);
  EXPECT_NEAR(growth_of(3, 9), 1, 1e-12);
  EXPECT_EQ(growth_of(1, 9), 1);                                // too wide is not told by so few
  EXPECT_NEAR(growth_of(100, 1), (4 + 46 * 36) / 50.0, 1e-12);  // one sample says so much at most
  EXPECT_NEAR(growth_of(1, 0), (4 + 46 * 36) / 50.0, 1e-12);
}

TEST(LeftOutFolds, FailuresTellNothing) {
  const Samples<2> samples = sample<2>(random_points<2>(20, 1), [](const Point<2>& x) { return x[0]; });
  EXPECT_EQ(left_out_folds<2>(samples, [](const Samples<2>&) -> FittedParts<2> { throw SolverFailure("singular"); }),
            Eigen::VectorXd::Ones(1));
  EXPECT_EQ(left_out_folds<2>(samples, [](const Samples<2>&) { return FittedParts<2>{}; }), Eigen::VectorXd::Ones(1));
}

TEST(LeftOutFolds, TooFewSamplesOfADegreeTellNothing) {
  const Samples<2> samples = sample<2>(random_points<2>(11, 1), franke);
  EXPECT_NO_THROW((void)fit<2>(samples, {.degree = 3}));  // whose ten monomials eleven determine, eight do not
}

TEST(LeftOutFolds, RoundingIsNoError) {
  const Samples<2> samples = sample<2>(random_points<2>(20, 1), [](const Point<2>&) { return 3.0; });
  const auto right = [](const Samples<2>&) {
    return FittedParts<2>{{std::make_shared<Constant>(3)}, {std::make_shared<Constant>(0)}};
  };
  EXPECT_EQ(left_out_folds<2>(samples, right)[0], 1);
}

// The function of Branin (1972) on the unit square.
double branin(const Point<2>& u) {
  const double pi = std::acos(-1.0), x = 15 * u[0] - 5, y = 15 * u[1];
  return std::pow(y - 5.1 / (4 * pi * pi) * x * x + 5 / pi * x - 6, 2) + 10 * (1 - 1 / (8 * pi)) * std::cos(x) + 10;
}

// Among few samples the function looks smoother than it is.
TEST(LeftOutFolds, IntervalsOfFewSamplesHoldTheFunction) {
  const Points<2> x = random_points<2>(500, 99);
  const Samples<2> truth = sample<2>(x, branin);
  double within = 0;
  constexpr int fits = 40;
  for (unsigned seed = 1; seed <= fits; ++seed) {
    const Fit<2> found = fit<2>(sample<2>(random_points<2>(14, seed), branin));
    const Eigen::ArrayXd error = (found.components[0]->evaluate(x).value - truth.values.col(0)).cwiseAbs();
    const Eigen::ArrayXd deviation = found.variances[0]->evaluate(x).value.cwiseSqrt();
    within += static_cast<double>((error < 1.96 * deviation).count()) / (500.0 * fits);
  }
  EXPECT_GT(within, 0.91);
  EXPECT_LT(within, 0.97);
}

}  // namespace
}  // namespace csrbf::left_out_folds_test
