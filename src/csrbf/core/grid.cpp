#include "csrbf/core/grid.hpp"

#include "csrbf/core/error.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <sstream>

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

double distance_apart(const Grid& a, const Grid& other) {
  constexpr double rounding = 0.01;  // of a voxel; chosen by hand
  const Grid b = in_space(other, a.space);
  double apart = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Point<3> voxel = Point<3>::Zero();
    for (Index k = 0; k < 3; ++k)
      if ((corner >> k & 1) != 0) voxel[k] = static_cast<double>(a.size[k] - 1);
    apart = std::max(apart, (a.to_physical<3>() * voxel - b.to_physical<3>() * voxel).norm());
  }
  return apart > rounding * a.spacing.head(a.dimension()).minCoeff() ? apart : 0;
}

std::string places_text(const Grid& a, const Grid& other) {
  const Grid b = in_space(other, a.space);
  const Eigen::IOFormat row(6, Eigen::DontAlignCols, ", ", ", ", "", "", "(", ")");
  std::ostringstream text;
  text << "spacing " << a.spacing.transpose().format(row) << " and " << b.spacing.transpose().format(row) << ", origin "
       << a.origin.transpose().format(row) << " and " << b.origin.transpose().format(row)
       << " or the directions differ";
  return text.str();
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
