#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/io/files/open_file.hpp"

#include <string>

namespace csrbf {

/// Reads the points of a file piece by piece, in their order, in little memory: binary .ply files whose first element
/// is the vertices, and .npy arrays in C order. All other formats of read_points() are read whole.
class PointStream {
 public:
  /// Throws IoError as read_points().
  explicit PointStream(const std::string& path);

  /// Number of points in the file.
  [[nodiscard]] Index size() const { return size_; }

  /// The points [begin, end), in any order of calls. Throws IoError when the file is damaged there.
  [[nodiscard]] PointCloud read(Index begin, Index end);

 private:
  bool open_ply(std::string_view start);
  bool open_npy(std::string_view start);

  std::string path_, extension_;
  Index size_ = 0;
  // Points of a fixed size behind a header.
  OpenFile file_;
  std::size_t data_begin_ = 0, point_size_ = 0;
  std::string before_count_, after_count_;  // the header of a .ply file of other points, but for their number
  PointCloud all_;                          // of formats that are read whole
};

}  // namespace csrbf
