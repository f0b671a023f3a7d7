#include "csrbf/approx/fit.hpp"
#include "csrbf/io/models/function_archive.hpp"
#include "io/models/function_testing.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::transform_archive_test {
namespace {

TEST(FunctionArchive, KeepsTransformedValues) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  Samples<1> samples{Points<1>(1, 60), Eigen::MatrixXd(60, 1), {}};
  for (Index i = 0; i < 60; ++i) {
    samples.points(0, i) = static_cast<double>(i) / 60;
    samples.values(i, 0) = std::exp(std::sin(9 * samples.points(0, i)) + uniform(random));
  }
  for (const char* transform : {"log", "sqrt"}) {
    FitOptions options;
    options.transform = transform;
    const Function function(fit(samples, options));
    const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(1, 50, [&] { return 1.5 * uniform(random) - .25; });
    const Archive archive = written_the_same(function, x);
    const Function read = function_from(archive).function;
    EXPECT_EQ(read.report().transforms, std::vector<std::string>{transform});
    EXPECT_EQ(read.standard_deviation(x, DeviationOf::function), function.standard_deviation(x, DeviationOf::function));
    for (const auto& [name, value] : archive.values()) {
      Archive bad = archive;
      if (name.ends_with("/transform"))
        bad.set(name, std::string("cube"));
      else if (name.ends_with("inner/noise"))
        bad.set(name, -1.0);
      else
        continue;
      EXPECT_THROW((void)function_from(bad), IoError) << name;
    }
  }
}

}  // namespace
}  // namespace csrbf::transform_archive_test
