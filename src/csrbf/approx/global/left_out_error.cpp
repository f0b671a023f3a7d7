#include "csrbf/approx/basis/polynomial_block.hpp"
#include "csrbf/approx/global/axis_covariance.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/linalg/saddle.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <algorithm>
#include <functional>
#include <limits>

namespace csrbf {

namespace {

// The polynomials of the trend at some of the samples.
using Trend = std::function<Eigen::MatrixXd(const std::vector<Index>& some)>;

// `scaled`: the places in lengths of the covariance, `order`: of these along a curve.
double left_out_error(const SampleView& samples, const Kernel& kernel, double nugget, const Eigen::MatrixXd& scaled,
                      const std::vector<Index>& order, const Trend& trend) {
  constexpr double largest_axis_jitter = 1e-9;             // see InterpolateOptions
  constexpr Index at_once = 800, block = 400, blocks = 4;  // samples; chosen by hand
  const Index n = samples.size(), size = n <= at_once ? n : block, core = n <= at_once ? n : block / 2;
  double sum = 0;
  Index count = 0;
  for (Index k = 0; k < (n <= at_once ? 1 : blocks); ++k) {
    std::vector<Index> near = order;
    const Eigen::VectorXd middle = scaled.col(order[(2 * k + 1) * n / (2 * blocks)]);
    Eigen::VectorXd distance(n);
    squared_distances(scaled, 0, middle.data(), distance.data());
    std::partial_sort(near.begin(), near.begin() + size, near.end(),
                      [&](Index a, Index b) { return distance[a] < distance[b]; });
    near.resize(static_cast<std::size_t>(size));
    const Eigen::MatrixXd x = scaled(Eigen::all, near);
    Eigen::VectorXd w(size), r2(size);
    for (Index i = 0; i < size; ++i) w[i] = samples.weight(near[static_cast<std::size_t>(i)]);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size);
    for (Index j = 0; j < size; ++j) {
      squared_distances(x, j, x.col(j).data(), r2.data());
      kernel.values(r2.data(), size - j, &A(j, j));
    }
    try {
      const SaddleOptions options{.lambda = nugget, .weights = w, .largest_rescue = largest_axis_jitter};
      const Eigen::MatrixXd errors =
          solve_saddle(A, trend(near), samples.values(near, Eigen::all), options).leave_one_out.topRows(core);
      sum += errors.cwiseAbs().sum();
      count += errors.size();
    } catch (const SolverFailure&) {
      return std::numeric_limits<double>::infinity();
    }
  }
  return sum / static_cast<double>(count);
}

}  // namespace

template <int Dim>
double left_out_error(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance) {
  const Points<Dim> scaled = in_lengths<Dim>(samples.points, covariance);
  return left_out_error(SampleView(samples), covariance.kernel, covariance.nugget, scaled, morton_order<Dim>(scaled),
                        [&](const std::vector<Index>& some) -> Eigen::MatrixXd {
                          const Points<Dim> x = chosen_points<Dim>(scaled, some);
                          return polynomial_block<Dim>(x, covariance.degree, RankDeficiency::reduce).G;
                        });
}

#define CSRBF_INSTANTIATE(Dim) template double left_out_error<Dim>(const Samples<Dim>&, const AxisCovariance<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
