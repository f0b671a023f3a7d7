#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/spatial/thinned_points.hpp"

#include <functional>
#include <string>
#include <vector>

namespace csrbf {

/// Appends the points of one tile after another to files, in buffers: any number of files, little memory. The files are
/// raw: point_bytes() for each point, three doubles, then three floats if there are normals.
class PointDealer {
 public:
  PointDealer(std::vector<std::string> paths, bool normals);

  void add(Index tile, const Point<3>& point, const Point<3>* normal);
  /// Writes what is in the buffers. Throws IoError.
  void flush();

 private:
  void flush(Index tile);

  std::vector<std::string> paths_;
  bool normals_;
  std::vector<std::string> buffers_;
  std::size_t most_;  // bytes in a buffer
};

/// The points of raw files, one after the other; missing files have none.
PointCloud read_raw_points(const std::vector<std::string>& paths, bool normals);

/// Writes a tile: its points along the curve and its levels of thinning, in blocks with their boxes. Throws IoError.
void write_tile_points(const std::string& path, const PointCloud& cloud, const ThinnedPoints& thinned);

/// What read_tile_points() appends to.
struct GatheredPoints {
  std::vector<double> points, normals;  ///< 3 each

  [[nodiscard]] Index size() const { return std::ssize(points) / 3; }
};

/// Appends the points of one level (0: all) that `wants_point` names, of blocks whose boxes `wants_box` names. A level
/// beyond the last has no points. Throws IoError.
void read_tile_points(const std::string& path, int level, const std::function<bool(const Box<3>&)>& wants_box,
                      const std::function<bool(const Point<3>&)>& wants_point, GatheredPoints& out);

}  // namespace csrbf
