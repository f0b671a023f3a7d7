#include "csrbf/levelset/contour/contour_distance.hpp"

#include "csrbf/levelset/image/signed_distance.hpp"

#include <Eigen/Geometry>

#include <algorithm>

namespace csrbf {

template <int Dim>
std::vector<float> contour_distance(const Grid& grid, const std::vector<std::uint8_t>& labels,
                                    const Field<Dim>& field) {
  const auto edge = static_cast<float>(grid.spacing.template head<Dim>().minCoeff());
  std::vector<float> distance = signed_distance(grid, labels.data());

  // Next to the contour the level set is more exact than the voxels.
  std::vector<Index> close;
  for (std::size_t i = 0; i < distance.size(); ++i)
    if (std::abs(distance[i]) < edge) close.push_back(static_cast<Index>(i));
  Points<Dim> points(Dim, static_cast<Index>(close.size()));
  const auto to_physical = grid.to_physical<Dim>();
  for (Index k = 0; k < points.cols(); ++k) {
    Index rest = close[k];
    Point<Dim> voxel;
    for (Index a = 0; a < Dim; ++a) {
      const Index size = grid.size[a];
      voxel[a] = static_cast<double>(rest % size);
      rest /= size;
    }
    points.col(k) = to_physical * voxel;
  }
  const Jet<Dim> jet = field.evaluate(points, Derivatives::gradient);
  const float farthest = 1.5F * edge;  // these voxels are at most an edge off; by hand, against small slopes
  for (Index k = 0; k < points.cols(); ++k) {
    const double slope = jet.gradient.col(k).norm();
    if (!(slope > 0)) continue;
    distance[close[static_cast<std::size_t>(k)]] =
        std::clamp(static_cast<float>(jet.value[k] / slope), -farthest, farthest);
  }
  return distance;
}

template std::vector<float> contour_distance<2>(const Grid&, const std::vector<std::uint8_t>&, const Field<2>&);
template std::vector<float> contour_distance<3>(const Grid&, const std::vector<std::uint8_t>&, const Field<3>&);

}  // namespace csrbf
