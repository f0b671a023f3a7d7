#include "csrbf/approx/unity/choose_local_options.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/core/parallel.hpp"

namespace csrbf::choose_local_options_test {
namespace {

Samples<2> noisy(Index count, double sigma) {
  Samples<2> data = sample<2>(random_points<2>(count, 1), franke);
  std::mt19937_64 random(5);
  std::normal_distribution<double> error(0, std::max(sigma, 1e-300));
  for (Index i = 0; i < count; ++i) data.values(i) += error(random);
  return data;
}

TEST(ChooseLocalOptions, KeepsWhatIsGiven) {
  const Samples<2> data = noisy(2000, .1);
  EXPECT_EQ(choose_local_options<2>(data, {.kernel = "gaussian"}).options.kernel, "gaussian");
  EXPECT_EQ(choose_local_options<2>(data, {.degree = 1}).options.degree, 1);
  EXPECT_EQ(choose_local_options<2>(data, {.samples_per_patch = 77}).options.samples, 77);
  EXPECT_EQ(choose_local_options<2>(data, {.centers_per_patch = 5}).options.centers, 5);
  EXPECT_EQ(choose_local_options<2>(data, {.anisotropy = .5}).options.anisotropy, .5);
  EXPECT_EQ(choose_local_options<2>(data, {.smoothing = .25}).options.smoothing, .25);
}

template <int Dim>
void expect_limits(Index count) {
  const Samples<Dim> data = sample<Dim>(random_points<Dim>(count, 1), waves<Dim>);
  const LocalOptions options = choose_local_options<Dim>(data, {}).options;
  EXPECT_GE(options.samples, 1) << Dim << " " << count;
  EXPECT_LE(options.samples, count) << Dim << " " << count;
  EXPECT_LE(options.centers, options.samples) << Dim << " " << count;
}

TEST(ChooseLocalOptions, StaysWithinTheSamples) {
  for (const Index count : {1, 2, 3, 5, 20, 300}) {
    expect_limits<1>(count);
    expect_limits<2>(count);
    expect_limits<3>(count);
  }
  expect_limits<4>(2);
  expect_limits<5>(10);
  expect_limits<6>(30);
}

TEST(ChooseLocalOptions, InterpolatesTooFewSamplesToTellNoise) {
  Samples<1> data{Points<1>(1, 2), Eigen::Vector2d(0, 5), {}};
  data.points << 1, 3;
  const LocalOptions options = choose_local_options<1>(data, {}).options;
  EXPECT_EQ(options.smoothing, 0);
  EXPECT_EQ(options.centers, 2);
}

TEST(ChooseLocalOptions, TakesLargePatchesUnderNoise) {
  const LocalOptions exact = choose_local_options<2>(noisy(20000, 0), {}).options;
  const LocalOptions rough = choose_local_options<2>(noisy(20000, .1), {}).options;
  EXPECT_EQ(exact.smoothing * static_cast<double>(exact.centers), 0);
  EXPECT_GT(rough.samples, 2 * exact.samples);
}

// The noise itself cannot be predicted; the function is known much better.
TEST(ChooseLocalOptions, EstimatesTheErrorOfPredictions) {
  const ChosenLocalOptions chosen = choose_local_options<2>(noisy(20000, .1), {});
  EXPECT_NEAR(chosen.rmse, .1, .01);
  EXPECT_NEAR(chosen.error, .1 * std::sqrt(2 / std::acos(-1)), .01);  // E|e| of a normal distribution
  EXPECT_LE(choose_local_options<2>(noisy(20000, 0), {}).rmse, 1e-6);
}

TEST(ChooseLocalOptions, TakesRoughKernelsForRoughFunctions) {
  const Samples<2> kinks = sample<2>(random_points<2>(5000, 1),
                                     [](const Point<2>& p) { return std::abs(std::sin(20 * (p[0] + p[1] * p[1]))); });
  EXPECT_LE(choose_local_options<2>(kinks, {}).options.degree, 2);
  const Samples<2> smooth = sample<2>(random_points<2>(5000, 1), waves<2>);
  EXPECT_GE(choose_local_options<2>(smooth, {}).options.degree, 3);
}

// Of a straight line a kernel alone is exact between samples, but not where a patch ends.
TEST(ChooseLocalOptions, TakesPolynomialsForStraightLines) {
  const Samples<1> data = sample<1>(random_points<1>(600, 1), [](const Point<1>& x) { return 3 * x[0] - 1; });
  EXPECT_GE(choose_local_options<1>(data, {}).options.degree, 1);
  const auto kink = [](const Point<1>& x) { return std::abs(x[0] - .37); };
  EXPECT_GE(choose_local_options<1>(sample<1>(random_points<1>(600, 1), kink), {}).options.degree, 1);
}

TEST(ChooseLocalOptions, DoesNotDependOnUnitsAndThreads) {
  const Samples<2> data = noisy(3000, .02);
  const LocalOptions options = choose_local_options<2>(data, {}).options;
  Samples<2> other = data;
  other.points *= 0x1p100;
  other.values *= 0x1p-600;
  other.weights = Eigen::VectorXd::Constant(3000, 0x1p900);
  EXPECT_EQ(choose_local_options<2>(other, {}).options, options);
  set_thread_count(1);
  EXPECT_EQ(choose_local_options<2>(data, {}).options, options);
  set_thread_count(0);
}

}  // namespace
}  // namespace csrbf::choose_local_options_test
