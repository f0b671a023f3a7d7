#include "csrbf/approx/basis/polynomial_block.hpp"
#include "csrbf/approx/global/axis_covariance.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/linalg/saddle.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <algorithm>
#include <limits>

namespace csrbf {

template <int Dim>
double left_out_error(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance) {
  constexpr double largest_axis_jitter = 1e-9;             // see InterpolateOptions
  constexpr Index at_once = 800, block = 400, blocks = 4;  // samples; chosen by hand
  const Index n = samples.size(), size = n <= at_once ? n : block, core = n <= at_once ? n : block / 2;
  const Points<Dim> scaled = in_lengths<Dim>(samples.points, covariance);
  const std::vector<Index> order = morton_order<Dim>(scaled);
  double sum = 0;
  Index count = 0;
  for (Index k = 0; k < (n <= at_once ? 1 : blocks); ++k) {
    std::vector<Index> near = order;
    const Point<Dim> middle = scaled.col(order[(2 * k + 1) * n / (2 * blocks)]);
    const auto distance = [&](Index i) { return (scaled.col(i) - middle).squaredNorm(); };
    std::partial_sort(near.begin(), near.begin() + size, near.end(),
                      [&](Index a, Index b) { return distance(a) < distance(b); });
    near.resize(static_cast<std::size_t>(size));
    const Points<Dim> x = chosen_points<Dim>(scaled, near);
    Eigen::VectorXd w(size), r2(size);
    for (Index i = 0; i < size; ++i) w[i] = samples.weight(near[static_cast<std::size_t>(i)]);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size);
    for (Index j = 0; j < size; ++j) {
      squared_distances<Dim>(x.data() + Dim * j, size - j, x.col(j), r2.data());
      covariance.kernel.values(r2.data(), size - j, &A(j, j));
    }
    const Eigen::MatrixXd G = polynomial_block<Dim>(x, covariance.degree, RankDeficiency::reduce).G;
    try {
      const SaddleOptions options{.lambda = covariance.nugget, .weights = w, .largest_rescue = largest_axis_jitter};
      const Eigen::MatrixXd errors =
          solve_saddle(A, G, samples.values(near, Eigen::all), options).leave_one_out.topRows(core);
      sum += errors.cwiseAbs().sum();
      count += errors.size();
    } catch (const SolverFailure&) {
      return std::numeric_limits<double>::infinity();
    }
  }
  return sum / static_cast<double>(count);
}

#define CSRBF_INSTANTIATE(Dim) template double left_out_error<Dim>(const Samples<Dim>&, const AxisCovariance<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
