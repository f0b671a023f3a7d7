#pragma once

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/grid.hpp"

#include <span>
#include <vector>

namespace csrbf {

/// count_components() of an image that comes some slices at a time.
class SlabComponents {
 public:
  /// `size`: voxels of a slice along x and y.
  SlabComponents(Index nx, Index ny) : nx_(nx), ny_(ny) {}

  /// Adds the slices that follow those before. Memory: one byte per voxel of these, and a few per run of equal labels.
  void add(std::span<const std::uint8_t> labels);

  /// Connected components, by the faces of voxels, of all labels but 0 so far.
  [[nodiscard]] Index count();

 private:
  Index nx_, ny_;
  std::vector<std::uint8_t> last_;        // labels of the last slice
  std::vector<std::uint32_t> last_part_;  // of each of its runs
  DisjointSets parts_{0};
};

}  // namespace csrbf
