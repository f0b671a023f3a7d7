#pragma once

#include "csrbf/core/types.hpp"

#include <string>
#include <vector>

namespace csrbf {

/// Type of the samples in an image file.
enum class SampleType { uint8, int8, uint16, int16, uint32, int32, uint64, int64, float32, float64 };

[[nodiscard]] constexpr bool is_floating(SampleType type) {
  return type == SampleType::float32 || type == SampleType::float64;
}

/// A regular lattice of voxels: voxel (i, j, k) is centred at origin + direction * diag(spacing) * (i, j, k). x is the
/// fastest axis. Axes that an image does not have are one voxel long.
struct Grid {
  int axes = 3;                                             ///< 1 to 3
  std::array<Index, 3> size{1, 1, 1};                       ///< voxels along x, y, z
  Point<3> spacing = Point<3>::Ones();                      ///< between neighbours along each axis; positive
  Point<3> origin = Point<3>::Zero();                       ///< centre of the first voxel
  Eigen::Matrix3d direction = Eigen::Matrix3d::Identity();  ///< columns: unit vectors of the axes; not singular
  Space space = Space::unknown;

  [[nodiscard]] Index voxels() const { return size[0] * size[1] * size[2]; }
  [[nodiscard]] Index index(Index x, Index y = 0, Index z = 0) const { return x + size[0] * (y + size[1] * z); }
  /// Number of axes without trailing ones of a single voxel; at least 1.
  [[nodiscard]] int dimension() const { return size[2] > 1 ? 3 : size[1] > 1 ? 2 : 1; }

  /// Maps voxel to physical coordinates (include <Eigen/Geometry> to call it). For Dim < 3: the first Dim coordinates
  /// of both, the others being 0. `grid.to_physical<3>() * points` maps the columns of a matrix.
  template <int Dim>
  [[nodiscard]] Eigen::Transform<double, Dim, Eigen::Affine> to_physical() const;

  /// Inverse of to_physical(). Throws InvalidInput if there is none, as for a slice that does not lie along the first
  /// Dim axes of space.
  template <int Dim>
  [[nodiscard]] Eigen::Transform<double, Dim, Eigen::Affine> to_voxel() const;

  /// Physical coordinates of the centres of all voxels, x fastest. Throws InvalidInput if the grid has more than Dim
  /// dimensions.
  template <int Dim>
  [[nodiscard]] Points<Dim> centers() const;
};

/// Numbers of voxels along the axes, for messages: "240 x 160 x 30".
std::string size_text(const Grid& grid);

/// Coordinates of the voxel with this index, for messages: "3, 0, 12".
std::string voxel_text(const Grid& grid, Index index);

/// The grid in another space: x and y change sign between the two patient spaces.
Grid in_space(Grid grid, Space space);

/// Largest distance between corresponding voxels of two grids of the same size; 0 below a hundredth of a voxel, because
/// files round positions.
double distance_apart(const Grid& a, const Grid& b);

/// How the positions of two grids differ, for messages: "spacing (1, 1, 1) and (1, 1, 2), origin ...".
std::string places_text(const Grid& a, const Grid& b);

/// Everything about an image except its values.
struct VolumeLayout {
  Grid grid;
  Index frames = 1;                       ///< images along the time axis; 1: no time axis
  double time_step = 1;                   ///< seconds between frames
  Index components = 1;                   ///< values per voxel: 3 for RGB
  SampleType type = SampleType::float32;  ///< of the samples in the file that it came from or goes to
  /// Coordinate reference system of x and y: "EPSG:32633", or text in WKT; empty: none, or unknown.
  std::string crs = {};

  [[nodiscard]] Index values_per_frame() const { return components * grid.voxels(); }
};

/// An image of 1 to 3 axes, or a time sequence of images. The component runs fastest, then x, y, z and time. Scalar is
/// float or double, whatever the file holds. float is exact for integers of up to 24 bits and takes half the memory:
/// 0.5 GB for 512^3 voxels, plus 0.27 GB while a 16-bit file is read; double takes 1.1 GB. Use double if samples of 32
/// or 64 bits must be preserved, as when filling holes of an image.
template <class Scalar>
struct Volume : VolumeLayout {
  std::vector<Scalar> values;  ///< values_per_frame() * frames of them

  Volume() = default;
  explicit Volume(const VolumeLayout& layout, Scalar value = 0)
      : VolumeLayout(layout), values(static_cast<std::size_t>(values_per_frame() * frames), value) {}

  using Values = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  /// One frame as a matrix, components x voxels.
  [[nodiscard]] Eigen::Map<Values> frame(Index t = 0) {
    return {values.data() + t * values_per_frame(), components, grid.voxels()};
  }
  [[nodiscard]] Eigen::Map<const Values> frame(Index t = 0) const {
    return {values.data() + t * values_per_frame(), components, grid.voxels()};
  }
};

}  // namespace csrbf
