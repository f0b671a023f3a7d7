#include "csrbf/io/models/function_archive.hpp"

#include "csrbf/approx/fit.hpp"
#include "io/models/function_testing.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::turned_axes_archive_test {
namespace {

TEST(FunctionArchive, KeepsTurnedAxes) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  Samples<2> samples{Points<2>::NullaryExpr(2, 400, [&] { return uniform(random); }), Eigen::MatrixXd(400, 1), {}};
  for (Index i = 0; i < 400; ++i) samples.values(i, 0) = std::sin(30 * samples.points.col(i).sum());
  const Function function(fit(samples));
  ASSERT_EQ(function.report().axes.size(), 2U);
  const Archive archive = written(function);
  const Function again = function_from(archive).function;
  EXPECT_EQ(again.report().axes, function.report().axes);
  const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(2, 300, [&] { return 1.5 * uniform(random) - .25; });
  expect_same(again, function, x);
  Archive bad = archive;
  for (const auto& [name, entry] : archive.values())
    if (name.ends_with("/map")) bad.set(name, Eigen::MatrixXd(Eigen::MatrixXd::Zero(2, 2)));
  EXPECT_THROW((void)function_from(bad), IoError);
}

}  // namespace
}  // namespace csrbf::turned_axes_archive_test
