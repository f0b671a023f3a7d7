#include "csrbf/io/models/average_archive.hpp"

#include "csrbf/approx/fit.hpp"
#include "csrbf/io/models/function_archive.hpp"
#include "io/models/function_testing.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::average_archive_test {
namespace {

TEST(FunctionArchive, KeepsAverages) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  Samples<2> samples{Points<2>::NullaryExpr(2, 25, [&] { return uniform(random); }), Eigen::MatrixXd(25, 1), {}};
  for (Index i = 0; i < 25; ++i) samples.values(i, 0) = std::sin(5 * samples.points(0, i)) + .2 * uniform(random);
  const Function function(fit(samples));
  const Archive archive = written(function);
  Archive bad = archive;
  int averages = 0;
  for (const auto& [name, entry] : archive.values())
    if (name.ends_with("/weights") && archive.has(name.substr(0, name.size() - 7) + "has_variances")) {
      ++averages;
      bad.set(name, Eigen::VectorXd(Eigen::VectorXd::Ones(3)));
    }
  ASSERT_EQ(averages, 2) << "the mean and the variance";
  EXPECT_THROW((void)function_from(bad), IoError);
  const Function again = function_from(archive).function;
  const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(2, 300, [&] { return 1.5 * uniform(random) - .25; });
  expect_same(again, function, x);
}

TEST(FunctionArchive, KeepsWhatASecondFitSaysOfTheFirst) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  Samples<2> samples{Points<2>::NullaryExpr(2, 60, [&] { return uniform(random); }), Eigen::MatrixXd(60, 2), {}};
  for (Index i = 0; i < 60; ++i)
    samples.values.row(i) << std::sin(5 * samples.points(0, i)) + .2 * uniform(random), samples.points(1, i) > .5;
  const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(2, 300, [&] { return 1.5 * uniform(random) - .25; });
  for (const char* method : {"multilevel", "along-tracks"}) {
    const Function function(fit(samples, {.method = method, .standard_deviation = true}));
    (void)written_the_same(function, x);
  }
}

// One system in the gaps of patches, and of what it leaves.
TEST(FunctionArchive, KeepsSystemsInGaps) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const Index n : {2600, 5200}) {
    Samples<2> samples{Points<2>(2, n), Eigen::MatrixXd(n, 1), {}};
    for (Index i = 0; i < n; ++i) {
      Point<2> x;
      do x = {uniform(random), uniform(random)};
      while ((x.array() - .5).matrix().norm() < .3);
      samples.points.col(i) = x;
      samples.values(i, 0) = std::sin(5 * x[0]) * std::cos(4 * x[1]);
    }
    const Function function(fit(samples));
    const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(2, 300, [&] { return uniform(random); });
    expect_same(function_from(written(function)).function, function, x);
  }
}

}  // namespace
}  // namespace csrbf::average_archive_test
