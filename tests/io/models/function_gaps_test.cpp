#include "csrbf/io/models/function_archive.hpp"

#include "csrbf/approx/fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace csrbf::function_gaps_test {
namespace {

// In the gap before one sample far from all others values are one system's: there are parts of cells, but none is wide.
TEST(FunctionArchive, KeepsOneSystemInGaps) {
  constexpr Index n = 20'000;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  Samples<1> samples{Points<1>(1, n + 1), Eigen::MatrixXd(n + 1, 1), {}};
  for (Index i = 0; i <= n; ++i) {
    const double t = i < n ? uniform(random) : 5;
    samples.points(0, i) = t;
    samples.values(i, 0) = i < n ? std::sin(5 * t) * std::cos(4 * t) + t : 1;
  }
  const Function function(fit<1>(samples));
  const Function read = function_from(parse_archive(format_archive(to_archive({function})), "model")).function;
  const Eigen::MatrixXd at = Eigen::RowVectorXd::LinSpaced(101, 0, 5);
  EXPECT_EQ(read.evaluate(at).value, function.evaluate(at).value);
  EXPECT_EQ(read.standard_deviation(at), function.standard_deviation(at));
}

}  // namespace
}  // namespace csrbf::function_gaps_test
