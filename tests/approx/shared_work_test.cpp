#include "csrbf/core/shared_work.hpp"

#include "core/shared_work_testing.hpp"
#include "csrbf/approx/function.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf {
namespace {

Samples<2> waves(Index n, double noise) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> error(0, 1);
  Samples<2> samples{Points<2>(2, n), Eigen::MatrixXd(n, 1), {}};
  for (Index i = 0; i < n; ++i) {
    samples.points.col(i) << unit(random), unit(random);
    samples.values(i, 0) =
        std::sin(9 * samples.points(0, i)) * std::cos(7 * samples.points(1, i)) + noise * error(random);
  }
  return samples;
}

// What fit and evaluation share, when their result is the same for every one of some processes.
std::map<std::string, Index> shared_by(const Samples<2>& samples, const FitOptions& options) {
  const Points<2> x = waves(3000, 0).points;
  const std::vector<Eigen::VectorXd> grid(2, Eigen::VectorXd::LinSpaced(70, 0, 1));
  return compare_with_ranks(
      3,
      [&] {
        const Function f(fit(samples, options));
        return std::pair{f.evaluate(x, Derivatives::gradient), f.evaluate_grid(grid)};
      },
      [](const auto& a, const auto& b) {
        EXPECT_TRUE(a.first.value == b.first.value);
        EXPECT_TRUE(a.first.gradient == b.first.gradient);
        EXPECT_TRUE(a.second == b.second);
      });
}

TEST(SharedWork, APartitionOfUnityIsTheSameForEveryProcess) {
  const auto items = shared_by(waves(60000, 0), {.method = "partition-of-unity"});
  EXPECT_GE(items.at("cover"), 256);
  EXPECT_GT(items.at("fit"), 10);
  EXPECT_GT(items.at("choose options"), 10);
  EXPECT_GT(items.at("evaluate"), 3000);
}

TEST(SharedWork, AFitOfNoisySamplesIsTheSameForEveryProcess) {
  shared_by(waves(5000, 0.05), {});
}

}  // namespace
}  // namespace csrbf
