#pragma once

#include "csrbf/core/grid.hpp"

#include <array>
#include <bit>
#include <string>
#include <string_view>

namespace csrbf {

/// The fields of a NIfTI header that are used here, under the names of the standard.
struct NiftiHeader {
  int version = 1;
  std::endian order = std::endian::little;
  std::array<std::int64_t, 8> dim{};
  int datatype = 0;
  int bits = 0;
  std::array<double, 8> pixdim{1, 1, 1, 1, 1, 1, 1, 1};
  double data_offset = 0;  ///< vox_offset
  double slope = 1;
  double intercept = 0;
  int units = 2 | 8;  ///< mm, s
  int qform_code = 0;
  int sform_code = 0;
  std::array<double, 3> quaternion{};
  std::array<double, 3> quaternion_offset{};
  Eigen::Matrix<double, 3, 4> sform = Eigen::Matrix<double, 3, 4>::Zero();

  [[nodiscard]] bool has_position() const { return sform_code > 0 || qform_code > 0; }
  /// Map from voxels to space: its matrix and its translation.
  [[nodiscard]] Eigen::Matrix3d linear(int axes) const;
  [[nodiscard]] Point<3> origin() const;
  /// Writes the position of a grid as sform, and as qform when its axes are orthogonal.
  void set_position(const Grid& grid);
};

/// Reads the header at the beginning of `bytes`, of either version and byte order. Throws IoError.
NiftiHeader parse_nifti_header(std::string_view bytes, const std::string& name);

/// The little-endian header, and the four bytes that announce that no extension follows.
std::string format_nifti_header(const NiftiHeader& header);

}  // namespace csrbf
