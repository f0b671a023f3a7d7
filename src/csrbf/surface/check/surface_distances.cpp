#include "csrbf/surface/check/surface_distances.hpp"

#include "csrbf/core/parallel.hpp"

namespace csrbf {
namespace {

constexpr double smallest_slope = 0.1;  // floor of |grad f|, which is about 1 near the surface; chosen by hand

}  // namespace

std::vector<double> surface_distances(const Field<3>& field, const PointsRef<3>& points, double diagonal) {
  constexpr Index grain = Field<3>::block_size;
  std::vector<double> distance(points.cols());
  const auto compute = [&](Index begin, Index end) {
    Eigen::Matrix<double, grain, 1> value;
    Eigen::Matrix<double, 3, grain> gradient;
    field.evaluate_block(points.middleCols(begin, end - begin), {value.data(), gradient.data(), nullptr});
    for (Index i = begin; i < end; ++i)
      distance[i] = std::abs(value[i - begin]) / std::max(gradient.col(i - begin).norm(), smallest_slope) / diagonal;
  };
  parallel_for(points.cols(), grain, compute);
  return distance;
}

}  // namespace csrbf
