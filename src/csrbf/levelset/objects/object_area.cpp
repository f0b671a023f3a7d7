#include "csrbf/levelset/objects/object_area.hpp"

#include <cmath>

namespace csrbf {
namespace {

constexpr Index margin = 3;  // voxels that the blur and its differences reach

}  // namespace

double object_area(std::span<const std::int32_t> labels, std::int32_t label, const VoxelBox& box, const Grid& grid) {
  std::array<Index, 3> size{1, 1, 1}, strides{1, 1, 1}, from = box.lo;
  double cell = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (grid.size[a] > 1) {
      size[a] = box.hi[a] - box.lo[a] + 1 + 2 * margin;
      from[a] -= margin;
      cell *= grid.spacing[static_cast<int>(a)];
    }
    strides[a] = a == 0 ? 1 : strides[a - 1] * size[a - 1];
  }
  const Index n = strides[2] * size[2];
  std::vector<float> image(static_cast<std::size_t>(n), 0.0F), copy;
  for (Index z = box.lo[2]; z <= box.hi[2]; ++z)
    for (Index y = box.lo[1]; y <= box.hi[1]; ++y)
      for (Index x = box.lo[0]; x <= box.hi[0]; ++x)
        if (labels[grid.index(x, y, z)] == label)
          image[(x - from[0]) + strides[1] * (y - from[1]) + strides[2] * (z - from[2])] = 1;
  // 1 2 1, twice along each axis: a variance of 1. The margin stays 0.
  for (std::size_t a = 0; a < 3; ++a)
    for (int pass = 0; size[a] > 1 && pass < 2; ++pass) {
      copy = image;
      for (Index i = strides[a]; i + strides[a] < n; ++i)
        image[i] = 0.25F * copy[i - strides[a]] + 0.5F * copy[i] + 0.25F * copy[i + strides[a]];
    }
  double sum = 0;
  for (Index i = 0; i < n; ++i) {
    double squares = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (size[a] == 1 || i < strides[a] || i + strides[a] >= n) continue;
      const double slope = static_cast<double>(image[i + strides[a]] - image[i - strides[a]]);
      squares += std::pow(slope / (2 * grid.spacing[static_cast<int>(a)]), 2);
    }
    sum += std::sqrt(squares);
  }
  return sum * cell;
}

}  // namespace csrbf
