#include "csrbf/core/grid.hpp"

#include "csrbf/core/error.hpp"

#include <Eigen/Geometry>

namespace csrbf {

template <int Dim>
Eigen::Transform<double, Dim, Eigen::Affine> Grid::to_physical() const {
  Eigen::Transform<double, Dim, Eigen::Affine> map = Eigen::Transform<double, Dim, Eigen::Affine>::Identity();
  map.linear() = direction.topLeftCorner<Dim, Dim>() * spacing.head<Dim>().asDiagonal();
  map.translation() = origin.head<Dim>();
  return map;
}

template <int Dim>
Eigen::Transform<double, Dim, Eigen::Affine> Grid::to_voxel() const {
  // The columns are unit vectors: for dependent ones rounding leaves a determinant of about machine precision.
  constexpr double singular = 1e-12;
  const double volume = direction.topLeftCorner<Dim, Dim>().determinant();
  require(std::abs(volume) > singular, "Grid::to_voxel", "determinant of the directions", volume,
          "must not be 0: the axes of the image must span the first axes of space");
  return to_physical<Dim>().inverse();
}

template <int Dim>
Points<Dim> Grid::centers() const {
  require(dimension() <= Dim, "Grid::centers", "dimension of the grid", dimension(),
          "must not exceed the dimension of the points");
  const auto map = to_physical<3>();
  Points<Dim> points(Dim, voxels());
  Index i = 0;
  for (Index z = 0; z < size[2]; ++z)
    for (Index y = 0; y < size[1]; ++y)
      for (Index x = 0; x < size[0]; ++x)
        points.col(i++) =
            (map * Point<3>(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z))).head<Dim>();
  return points;
}

std::string size_text(const Grid& grid) {
  std::string text;
  for (std::size_t a = 0; a < static_cast<std::size_t>(std::max(grid.axes, grid.dimension())); ++a)
    text += (a > 0 ? " x " : "") + std::to_string(grid.size[a]);
  return text;
}

std::string voxel_text(const Grid& grid, Index index) {
  std::string text;
  for (std::size_t a = 0; a < static_cast<std::size_t>(grid.dimension()); index /= grid.size[a++])
    text += (a > 0 ? ", " : "") + std::to_string(index % grid.size[a]);
  return text;
}

Grid in_space(Grid grid, Space space) {
  if (grid.space != Space::unknown && space != Space::unknown && grid.space != space) {
    grid.direction.topRows(2) *= -1;
    grid.origin.head(2) *= -1;
  }
  grid.space = space;
  return grid;
}

#define CSRBF_INSTANTIATE(Dim)                                                          \
  template Eigen::Transform<double, Dim, Eigen::Affine> Grid::to_physical<Dim>() const; \
  template Eigen::Transform<double, Dim, Eigen::Affine> Grid::to_voxel<Dim>() const;    \
  template Points<Dim> Grid::centers<Dim>() const;
CSRBF_INSTANTIATE(1)
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
