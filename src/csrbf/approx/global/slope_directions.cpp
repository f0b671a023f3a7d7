#include "csrbf/approx/global/slope_directions.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index most_samples = 2000;
constexpr double least_slope = 1e-3;  // mean squares, of the largest
constexpr double gain = 1;            // logarithm of the ratio of squared volumes: a correlation of slopes of .8

}  // namespace

template <int Dim>
std::optional<Eigen::Matrix<double, Dim, Dim>> slope_directions(const Samples<Dim>& samples) {
  using Matrix = Eigen::Matrix<double, Dim, Dim>;
  constexpr Index unknowns = symmetric_size<Dim> + 1, neighbours = 2 * Dim + 2;
  const Index n = samples.size(), stride = 1 + n / most_samples;
  if (Dim == 1 || n < 4 * unknowns) return std::nullopt;
  const KdTree<Dim> tree(samples.points);
  Eigen::MatrixXd steps(Dim, (n / stride + 1) * neighbours);
  Eigen::VectorXd squares(steps.cols());
  const Eigen::RowVectorXd spread = (samples.values.rowwise() - samples.values.colwise().mean()).colwise().norm();
  Index count = 0;
  std::array<Index, neighbours + 1> near{};
  std::array<double, neighbours + 1> distances{};
  for (Index i = 0; i < n; i += stride) {
    const Index found = tree.nearest(samples.points.col(i), neighbours + 1, near.data(), distances.data());
    for (Index k = 0; k < found; ++k) {
      const Index j = near[static_cast<std::size_t>(k)];
      if (j == i || count == steps.cols()) continue;
      steps.col(count) = samples.points.col(j) - samples.points.col(i);
      double sum = 0;
      for (Index c = 0; c < samples.components(); ++c)
        if (spread[c] > 0) sum += std::pow((samples.values(j, c) - samples.values(i, c)) / spread[c], 2);
      squares[count++] = sum;
    }
  }
  Eigen::VectorXd lengths = steps.leftCols(count).colwise().squaredNorm();
  if (count == 0) return std::nullopt;
  const double usual = median(lengths);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns), row(unknowns);
  for (Index k = 0; k < count; ++k) {
    const Point<Dim> step = steps.col(k) / std::sqrt(usual);
    Index entry = 0;
    row[entry++] = 1;
    for (int a = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b) row[entry++] = (a == b ? 1 : 2) * step[a] * step[b];
    const double weight = 1 / std::pow(1 + step.squaredNorm(), 2);  // errors grow with the expectation
    normal += weight * row * row.transpose();
    right += weight * squares[k] * row;
  }
  const Eigen::VectorXd solution = solve(Eigen::LDLT<Eigen::MatrixXd>(normal), right);
  if (!solution.allFinite()) return std::nullopt;
  Matrix slopes;
  for (int a = 0, entry = 1; a < Dim; ++a)
    for (int b = a; b < Dim; ++b, ++entry) slopes(a, b) = slopes(b, a) = solution[entry];
  const SymmetricEigen eigen = symmetric_eigen(slopes);
  const double largest = eigen.values.maxCoeff();
  if (!(largest > 0)) return std::nullopt;
  const Point<Dim> values = eigen.values.cwiseMax(least_slope * largest);
  const Matrix directions = eigen.vectors;
  const Matrix sound = directions * values.asDiagonal() * directions.transpose();
  if (!(sound.diagonal().array().log().sum() - values.array().log().sum() > gain)) return std::nullopt;
  return directions;
}

#define CSRBF_INSTANTIATE(Dim) \
  template std::optional<Eigen::Matrix<double, Dim, Dim>> slope_directions<Dim>(const Samples<Dim>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
