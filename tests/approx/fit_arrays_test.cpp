#include "csrbf/approx/fit.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/core/error.hpp"

#include <array>
#include <string>
#include <vector>

namespace csrbf::fit_arrays_test {
namespace {

TEST(FitArrays, TakesPointsAndValuesInVectors) {
  const Samples<2> data = sample<2>(random_points<2>(300, 1), franke);
  std::vector<std::array<double, 2>> points;
  std::vector<double> values;
  for (Index i = 0; i < data.size(); ++i) {
    points.push_back({data.points(0, i), data.points(1, i)});
    values.push_back(data.values(i, 0));
  }
  const auto from_vectors = fit<2>(points, values).components[0];
  const auto from_matrices = fit<2>(data).components[0];
  const std::vector<double> found = from_vectors->evaluate(points);
  const Eigen::VectorXd expected = from_matrices->evaluate(data.points).value;
  ASSERT_EQ(static_cast<Index>(found.size()), data.size());
  for (Index i = 0; i < data.size(); ++i) EXPECT_EQ(found[i], expected[i]);
}

TEST(FitArrays, SaysThatPointsAreColumns) {
  const Eigen::MatrixXd rows = random_points<2>(300, 1).transpose();
  const auto message = [](const auto& make) -> std::string {
    try {
      make();
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message([&] { (void)make_samples<2>(rows, Eigen::VectorXd::Ones(300)); }),
            "Samples: rows of points = 300: must be 2: one column per point; transpose an N x 2 matrix");
  // What Eigen makes of such a matrix where assertions are off.
  const Samples<2> taken{rows.topRows(2), Eigen::VectorXd::Ones(300), {}};
  EXPECT_EQ(message([&] { (void)fit<2>(taken); }),
            "fit: values = 300: there must be one row of values per point; points are columns: transpose the N x 2 "
            "matrix");
}

}  // namespace
}  // namespace csrbf::fit_arrays_test
