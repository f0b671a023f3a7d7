#pragma once

#include "csrbf/core/error.hpp"
#include "csrbf/core/types.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace csrbf {

/// Type of the samples of an image in its file.
enum class SampleType { uint8, int8, uint16, int16, uint32, int32, uint64, int64, float32, float64 };

[[nodiscard]] constexpr bool is_floating(SampleType type) {
  return type == SampleType::float32 || type == SampleType::float64;
}

/// What the physical axes of an image mean: nothing, or those of a patient in mm (x to the left or right, y to the back
/// or front, z to the head).
enum class Space { unknown, left_posterior_superior, right_anterior_superior };

/// A regular lattice of voxels: voxel (i, j, k) is centred at origin + direction * diag(spacing) * (i, j, k). x is the
/// fastest axis. Axes that an image does not have are one voxel long.
struct Grid {
  int axes = 3;                                             ///< 1 to 3
  std::array<Index, 3> size{1, 1, 1};                       ///< voxels along x, y, z
  Point<3> spacing = Point<3>::Ones();                      ///< distance of neighbours along each axis; positive
  Point<3> origin = Point<3>::Zero();                       ///< centre of the first voxel
  Eigen::Matrix3d direction = Eigen::Matrix3d::Identity();  ///< columns: unit vectors of the axes; not singular
  Space space = Space::unknown;

  [[nodiscard]] Index voxels() const { return size[0] * size[1] * size[2]; }
  [[nodiscard]] Index index(Index x, Index y = 0, Index z = 0) const { return x + size[0] * (y + size[1] * z); }
  /// Number of axes without trailing ones of a single voxel; at least 1.
  [[nodiscard]] int dimension() const { return size[2] > 1 ? 3 : size[1] > 1 ? 2 : 1; }

  /// Map from voxel to physical coordinates; for Dim < 3 the first Dim coordinates of both, and the rest 0.
  /// `grid.to_physical<3>() * points` maps the columns of a matrix.
  template <int Dim>
  [[nodiscard]] Eigen::Transform<double, Dim, Eigen::Affine> to_physical() const {
    Eigen::Transform<double, Dim, Eigen::Affine> map = Eigen::Transform<double, Dim, Eigen::Affine>::Identity();
    map.linear() = direction.topLeftCorner<Dim, Dim>() * spacing.head<Dim>().asDiagonal();
    map.translation() = origin.head<Dim>();
    return map;
  }

  /// Inverse of to_physical. Throws InvalidInput when there is none: for a slice that does not lie along the first Dim
  /// axes of space.
  template <int Dim>
  [[nodiscard]] Eigen::Transform<double, Dim, Eigen::Affine> to_voxel() const {
    // Unit columns: rounding alone leaves a determinant of the order of the machine precision.
    constexpr double singular = 1e-12;
    const double volume = direction.topLeftCorner<Dim, Dim>().determinant();
    require(std::abs(volume) > singular, "Grid::to_voxel", "determinant of the directions", volume,
            "must not be 0: the axes of the image must span the first axes of space");
    return to_physical<Dim>().inverse();
  }

  /// Physical coordinates of the centres of all voxels, x fastest. Throws InvalidInput when the grid has more than Dim
  /// dimensions.
  template <int Dim>
  [[nodiscard]] Points<Dim> centers() const {
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
};

/// Voxels along the axes, for messages: "240 x 160 x 30".
inline std::string size_text(const Grid& grid) {
  std::string text;
  for (std::size_t a = 0; a < static_cast<std::size_t>(std::max(grid.axes, grid.dimension())); ++a)
    text += (a > 0 ? " x " : "") + std::to_string(grid.size[a]);
  return text;
}

/// Where the voxel of that index is, for messages: "3, 0, 12".
inline std::string voxel_text(const Grid& grid, Index index) {
  std::string text;
  for (std::size_t a = 0; a < static_cast<std::size_t>(grid.dimension()); index /= grid.size[a++])
    text += (a > 0 ? ", " : "") + std::to_string(index % grid.size[a]);
  return text;
}

/// The grid in another space: x and y change their sign between the two of patients.
inline Grid in_space(Grid grid, Space space) {
  if (grid.space != Space::unknown && space != Space::unknown && grid.space != space) {
    grid.direction.topRows(2) *= -1;
    grid.origin.head(2) *= -1;
  }
  grid.space = space;
  return grid;
}

/// Everything about an image but its values.
struct VolumeLayout {
  Grid grid;
  Index frames = 1;                       ///< images along the time axis; 1: it has none
  double time_step = 1;                   ///< s, between frames
  Index components = 1;                   ///< values per voxel: 3 for RGB
  SampleType type = SampleType::float32;  ///< of the samples in the file it came from or goes to

  [[nodiscard]] Index values_per_frame() const { return components * grid.voxels(); }
};

/// A scientific image of 1 to 3 axes, as a still or a sequence. The component runs fastest, then x, y, z, time.
/// Scalar is float or double, whatever the file holds. float is exact for integers up to 24 bits and half the memory:
/// 512^3 voxels take 0.5 GB (and 0.27 GB more while a 16-bit file is read), double 1.1 GB. Take double where the
/// values of a file of 32 or 64-bit samples must survive, as when filling holes of an image.
template <class Scalar>
struct Volume : VolumeLayout {
  std::vector<Scalar> values;  ///< values_per_frame() * frames

  Volume() = default;
  explicit Volume(const VolumeLayout& layout, Scalar value = 0)
      : VolumeLayout(layout), values(static_cast<std::size_t>(values_per_frame() * frames), value) {}

  using Values = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  /// One frame as components x voxels.
  [[nodiscard]] Eigen::Map<Values> frame(Index t = 0) {
    return {values.data() + t * values_per_frame(), components, grid.voxels()};
  }
  [[nodiscard]] Eigen::Map<const Values> frame(Index t = 0) const {
    return {values.data() + t * values_per_frame(), components, grid.voxels()};
  }
};

}  // namespace csrbf
