#pragma once

#include "csrbf/core/grid.hpp"

#include <Eigen/Geometry>

#include <optional>

namespace csrbf::dicom {

/// The position of a slice, from the header of its file.
struct Slice {
  std::string path;
  std::string series, description;  ///< unique name, and a readable one
  bool placed = false;              ///< has position and orientation
  Point<3> origin = Point<3>::Zero();
  Eigen::Matrix<double, 3, 2> axes = Eigen::Matrix<double, 3, 2>::Identity();  ///< directions of rows and columns

  [[nodiscard]] Point<3> normal() const { return axes.col(0).cross(axes.col(1)); }
};

/// The samples of a file.
struct Image {
  std::array<Index, 3> size{1, 1, 1};  ///< the last is the number of frames
  bool is_sequence = false;            ///< frames follow each other in time
  double time_step = 1;                ///< s
  Point<3> spacing = Point<3>::Ones();
  SampleType type = SampleType::uint8;
  double slope = 1, intercept = 0;
  std::string samples;
};

/// The header of a DICOM file with an image; nothing for other files. Throws IoError when the file is damaged.
std::optional<Slice> read_header(const std::string& path);

/// The samples of a file that read_header() accepted. Throws IoError when they cannot be read or used.
Image read_image(const std::string& path);

}  // namespace csrbf::dicom
