#include "csrbf/approx/images/hole_boxes.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

// Moves the voxels that neighbours connect with `first` to a hole.
std::vector<Index> take_hole(VoxelMask& left, const Grid& grid, Index first) {
  std::vector<Index> hole{first};
  left[first] = 0;
  const auto& size = grid.size;
  for (std::size_t next = 0; next < hole.size(); ++next) {
    const Index x = hole[next] % size[0], y = hole[next] / size[0] % size[1], z = hole[next] / size[0] / size[1];
    for (Index c = std::max<Index>(0, z - 1); c <= std::min(size[2] - 1, z + 1); ++c)
      for (Index b = std::max<Index>(0, y - 1); b <= std::min(size[1] - 1, y + 1); ++b)
        for (Index a = std::max<Index>(0, x - 1); a <= std::min(size[0] - 1, x + 1); ++a) {
          const Index i = grid.index(a, b, c);
          if (left[i] == 0) continue;
          left[i] = 0;
          hole.push_back(i);
        }
  }
  std::sort(hole.begin(), hole.end());
  return hole;
}

}  // namespace

std::vector<Index> HoleBox::voxels(const Grid& grid) const {
  std::vector<Index> result;
  for (Index z = begin[2]; z < end[2]; ++z)
    for (Index y = begin[1]; y < end[1]; ++y)
      for (Index x = begin[0]; x < end[0]; ++x) result.push_back(grid.index(x, y, z));
  return result;
}

Grid HoleBox::grid(const Grid& of_image) const {
  Grid box = of_image;
  for (std::size_t a = 0; a < 3; ++a) box.size[a] = end[a] - begin[a];
  return box;
}

std::vector<HoleBox> hole_boxes(const VoxelMask& missing, const Grid& grid) {
  const double rim = rim_of(missing, grid);
  std::array<Index, 3> around{};
  for (std::size_t a = 0; a < 3; ++a)
    around[a] = static_cast<Index>(std::ceil(rim / grid.spacing[static_cast<Index>(a)]));
  VoxelMask left = missing;
  std::vector<HoleBox> boxes;
  Index voxels = 0;
  for (std::size_t first = 0; first < left.size(); ++first) {
    if (left[first] == 0) continue;
    HoleBox box{grid.size, {0, 0, 0}, take_hole(left, grid, static_cast<Index>(first))};
    for (const Index i : box.hole) {
      const std::array<Index, 3> at{i % grid.size[0], i / grid.size[0] % grid.size[1], i / grid.size[0] / grid.size[1]};
      for (std::size_t a = 0; a < 3; ++a) {
        box.begin[a] = std::min(box.begin[a], std::max<Index>(0, at[a] - around[a]));
        box.end[a] = std::max(box.end[a], std::min(grid.size[a], at[a] + around[a] + 1));
      }
    }
    voxels += box.grid(grid).voxels();
    if (voxels > grid.voxels()) return {};
    boxes.push_back(std::move(box));
  }
  return boxes.size() > 1 ? std::move(boxes) : std::vector<HoleBox>();
}

Index largest_hole(VoxelMask missing, const Grid& grid) {
  Index largest = 0;
  for (std::size_t first = 0; first < missing.size(); ++first)
    if (missing[first] != 0)
      largest = std::max(largest, std::ssize(take_hole(missing, grid, static_cast<Index>(first))));
  return largest;
}

VoxelMask some_holes(VoxelMask holes, const Grid& grid) {
  constexpr std::size_t enough = 6;  // chosen by hand
  if (holes.empty() || long_axes(grid).size() < 3) return holes;
  const std::vector<HoleBox> boxes = hole_boxes(holes, grid);
  if (boxes.size() <= enough) return holes;
  VoxelMask some(holes.size(), 0);
  for (std::size_t k = 0; k < enough; ++k)
    for (const Index i : boxes[(2 * k + 1) * boxes.size() / (2 * enough)].hole) some[i] = 1;
  return some;
}

}  // namespace csrbf
