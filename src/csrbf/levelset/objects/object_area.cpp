#include "csrbf/levelset/objects/object_area.hpp"

#include "csrbf/core/voxel_axes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace csrbf {
namespace {

// Points on half of the unit circle or sphere, evenly; on the sphere along a spiral of golden angles.
std::vector<Point<3>> even_directions(bool deep) {
  constexpr int count = 2000;
  std::vector<Point<3>> result;
  for (int k = 0; k < count; ++k) {
    const double z = deep ? 1 - (k + 0.5) / count : 0, around = std::sqrt(1 - z * z);
    const double angle = (k + 0.5) * std::numbers::pi * (deep ? 3 - std::sqrt(5.0) : 1.0 / count);
    result.emplace_back(around * std::cos(angle), around * std::sin(angle), z);
  }
  return result;
}

}  // namespace

std::vector<ObjectLines> object_lines(const Grid& grid) {
  const bool deep = grid.dimension() == 3;
  std::vector<ObjectLines> lines;
  std::vector<Point<3>> along;
  const Eigen::Matrix3d steps = voxel_axes(grid);
  const Index reach = deep ? 1 : 2, deepest = deep ? 1 : 0;
  for (Index z = -deepest; z <= deepest; ++z)
    for (Index y = -reach; y <= reach; ++y)
      for (Index x = -reach; x <= reach; ++x) {
        const bool opposite = 25 * z + 5 * y + x <= 0, repeated = !deep && x % 2 == 0 && y % 2 == 0;
        if (opposite || repeated) continue;
        lines.push_back({{x, y, z}, 0});
        along.emplace_back(steps * Point<3>(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)));
      }
  // Each stands for the directions to which it is the nearest, by a share of the mean over all.
  const std::vector<Point<3>> all = even_directions(deep);
  const double cell = voxel_volume(grid), mean = deep ? 4 : std::numbers::pi;
  for (const Point<3>& direction : all) {
    const auto cosine = [&](const Point<3>& line) { return std::abs(line.dot(direction)) / line.norm(); };
    const auto nearest = std::max_element(along.begin(), along.end(),
                                          [&](const Point<3>& a, const Point<3>& b) { return cosine(a) < cosine(b); });
    lines[nearest - along.begin()].area_per_end += mean * cell / nearest->norm() / static_cast<double>(all.size());
  }
  return lines;
}

double object_area(std::span<const std::int32_t> labels, std::int32_t label, const VoxelBox& box, const Grid& grid,
                   std::span<const ObjectLines> lines) {
  const auto is_object = [&](Index x, Index y, Index z) {
    const bool within =
        x >= box.lo[0] && x <= box.hi[0] && y >= box.lo[1] && y <= box.hi[1] && z >= box.lo[2] && z <= box.hi[2];
    return within && labels[grid.index(x, y, z)] == label;
  };
  double area = 0;
  for (Index z = box.lo[2]; z <= box.hi[2]; ++z)
    for (Index y = box.lo[1]; y <= box.hi[1]; ++y)
      for (Index x = box.lo[0]; x <= box.hi[0]; ++x) {
        if (!is_object(x, y, z)) continue;
        for (const auto& [step, area_per_end] : lines)
          if (!is_object(x + step[0], y + step[1], z + step[2])) area += area_per_end;
      }
  return area;
}

}  // namespace csrbf
