#include "csrbf/approx/fit.hpp"
#include "csrbf/io/models/function_archive.hpp"
#include "io/models/function_testing.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::variance_archive_test {
namespace {

// Deviations beyond the samples; models written before they grew have those of the covariance.
TEST(FunctionArchive, KeepsTheGrowthOfVariances) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  Samples<2> samples{Points<2>(2, 300), Eigen::MatrixXd(300, 1), {}};
  for (Index i = 0; i < 300; ++i) {
    Point<2> x(uniform(random), uniform(random));
    if (x.sum() > 1) x = Point<2>::Ones() - x;
    samples.points.col(i) = x;
    samples.values(i, 0) = std::sin(5 * x[0]) * std::cos(4 * x[1]);
  }
  const Function function(fit(samples));
  const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(2, 300, [&] { return uniform(random); });
  const Archive archive = written_the_same(function, x);
  Archive old = emptied(archive), bad = archive;
  int entries = 0;
  for (const auto& [name, value] : archive.values()) {
    const bool is_growth = name.ends_with("/growth_factor") || name.ends_with("/growth_distance");
    if (!is_growth) old.insert(name, value);
    if (is_growth) bad.set(name, 0.5);
    entries += is_growth ? 1 : 0;
  }
  ASSERT_GT(entries, 0);
  const Eigen::MatrixXd before = function_from(old).function.standard_deviation(x),
                        now = function.standard_deviation(x);
  EXPECT_TRUE((before.array() <= (1 + 1e-12) * now.array()).all());
  EXPECT_GT(now.maxCoeff(), 1.5 * before.maxCoeff());
  EXPECT_THROW((void)function_from(bad), IoError);
}

// What is known at least where nothing is smooth.
TEST(FunctionArchive, KeepsTheLeastOfVariances) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  Samples<1> samples{Points<1>(1, 300), Eigen::MatrixXd(300, 1), {}};
  double value = 0;
  for (Index i = 0; i < 300; ++i) {
    samples.points(0, i) = static_cast<double>(i);
    samples.values(i, 0) = value += uniform(random) - 0.5;
  }
  const Function function(fit(samples));
  const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(1, 300, [&] { return std::floor(300 * uniform(random)); });
  const Archive archive = written_the_same(function, x);
  Archive bad = archive;
  int entries = 0;
  for (const auto& [name, least] : archive.values()) {
    if (!name.ends_with("/growth_least")) continue;
    EXPECT_GT(archive.number(name), 1e-6);  // above rounding
    bad.set(name, 2.0);
    ++entries;
  }
  ASSERT_GT(entries, 0);
  EXPECT_THROW((void)function_from(bad), IoError);
}

// Of which no covariance can be chosen, but several are likely.
TEST(FunctionArchive, KeepsDeviationsOfFewSamples) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const Index n : {2, 3, 4, 5}) {
    Samples<2> samples{Points<2>::NullaryExpr(2, n, [&] { return uniform(random); }), Eigen::MatrixXd(n, 1), {}};
    samples.values.col(0) = (3 * samples.points.colwise().sum().array()).sin();
    const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(2, 50, [&] { return 2 * uniform(random) - .5; });
    const Function function(fit(samples));
    (void)written_the_same(function, x);
    (void)written_the_same(function.extrapolated(Extrapolation::linear), x);
  }
}

// Where samples are sparse the deviation grows with the distance to the nearest: for that the file holds where they
// are, and not much more.
TEST(FunctionArchive, KeepsThePlacesOfSamples) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  Samples<3> samples{Points<3>::NullaryExpr(3, 8000, [&] { return uniform(random); }), Eigen::MatrixXd(8000, 1), {}};
  samples.values.col(0) = (3 * samples.points.colwise().sum().array()).sin();
  const Function function(fit(samples, {.method = "partition-of-unity"}));
  const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(3, 300, [&] { return uniform(random); });
  const Archive archive = written_the_same(function, x);
  EXPECT_LE(format_archive(to_archive({function})).size(), 8000 * 250);  // 184 of them for the function itself
  int entries = 0;
  for (const auto& [name, value] : archive.values()) {
    const bool is_growth = name.ends_with("/amount") || name.ends_with("/exponent"),
               is_place = name.ends_with("/points");
    if (!is_growth && !is_place) continue;
    ++entries;
    Archive bad = archive;
    if (is_growth) bad.set(name, -1.0);
    if (is_place) bad.set(name, Eigen::MatrixXd(3, 0));
    EXPECT_THROW((void)function_from(bad), IoError) << name;
  }
  EXPECT_EQ(entries, 3);
}

}  // namespace
}  // namespace csrbf::variance_archive_test
