#include "csrbf/io/models/function_archive.hpp"

#include "csrbf/approx/fit.hpp"
#include "io/models/function_testing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace csrbf::rough_gaps_archive_test {
namespace {

// Steps across many lines, around a square without samples.
Samples<2> rough_samples() {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Points<2> all = Points<2>::NullaryExpr(2, 3000, [&] { return uniform(random); });
  std::vector<Index> kept;
  for (Index i = 0; i < all.cols(); ++i)
    if ((all.col(i).array() - .5).abs().maxCoeff() > .15) kept.push_back(i);
  Samples<2> samples{all(Eigen::all, kept), Eigen::MatrixXd::Zero(std::ssize(kept), 1), {}};
  for (int k = 0; k < 2000; ++k) {
    const double angle = 2.399963 * k, offset = std::fmod(.618034 * k, 1.0) - .5;
    for (Index i = 0; i < samples.size(); ++i) {
      const double side = std::cos(angle) * (samples.points(0, i) - .5) + std::sin(angle) * (samples.points(1, i) - .5);
      samples.values(i, 0) += side > offset ? (k % 7 < 3 ? 1 : -.75) : 0;
    }
  }
  return samples;
}

TEST(FunctionArchive, KeepsTheSystemThatFillsRoughGaps) {
  const Function function(fit(rough_samples()));
  const Archive archive = written(function);
  EXPECT_TRUE(std::any_of(archive.values().begin(), archive.values().end(),
                          [](const auto& entry) { return entry.first.find("other") != std::string::npos; }));
  const Function again = function_from(archive).function;
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> uniform(-.3, 1.3);
  const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(2, 300, [&] { return uniform(random); });
  expect_same(again, function, x);
}

}  // namespace
}  // namespace csrbf::rough_gaps_archive_test
