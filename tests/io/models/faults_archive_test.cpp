#include "csrbf/approx/fit.hpp"
#include "csrbf/io/models/function_archive.hpp"
#include "io/models/function_testing.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::faults_archive_test {
namespace {

// Deviations follow from the samples of the discs; models written before they did have one for each disc.
TEST(FunctionArchive, KeepsTheDeviationsBesideFaults) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  Samples<2> samples{Points<2>(2, 200), Eigen::MatrixXd(200, 1), {}};
  for (Index i = 0; i < 200; ++i) {
    samples.points.col(i) << uniform(random), uniform(random);
    samples.values(i, 0) = std::sin(5 * samples.points(0, i)) + (samples.points(1, i) > .5 ? 2 : 0);
  }
  Eigen::Matrix2Xd line(2, 2);
  line << -1, 2, .5, .5;
  const Function function(fit<2>(samples, {.faults = {line}}));
  const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(2, 300, [&] { return uniform(random); });
  const Archive archive = written_the_same(function, x);
  Archive old = emptied(archive), bad = archive;
  int entries = 0;
  for (const auto& [name, value] : archive.values()) {
    const std::string start = name.substr(0, name.rfind('/') + 1);
    if (name.ends_with("/disc_weights")) bad.set(name, Eigen::MatrixXd(-archive.numbers(name, -1, -1)));
    if (name.ends_with("/disc_sigma2")) {
      ++entries;
      old.insert(start + "disc_variances", value);
    } else if (!name.ends_with("/disc_weights")) {
      old.insert(name, value);
    }
  }
  ASSERT_GT(entries, 0);
  const Function older = function_from(old).function;
  EXPECT_EQ(older.evaluate(x).value, function.evaluate(x).value);
  EXPECT_TRUE((older.standard_deviation(x).array() > 0).all());
  EXPECT_THROW((void)function_from(bad), IoError);
}

}  // namespace
}  // namespace csrbf::faults_archive_test
