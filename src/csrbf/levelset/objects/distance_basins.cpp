#include "csrbf/levelset/objects/distance_basins.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "csrbf/spatial/distance_transform.hpp"

namespace csrbf {
namespace {

// The steps to all neighbours of a voxel.
struct Step {
  std::array<Index, 3> by;
  Index offset;
};

std::vector<Step> steps_of(const Grid& grid) {
  std::vector<Step> steps;
  for (Index z = -1; z <= 1; ++z)
    for (Index y = -1; y <= 1; ++y)
      for (Index x = -1; x <= 1; ++x)
        if (x != 0 || y != 0 || z != 0) steps.push_back({{x, y, z}, grid.index(x, y, z)});
  return steps;
}

std::vector<float> smooth_distance(const std::vector<std::uint8_t>& inside, const Grid& grid) {
  std::vector<std::uint8_t> outside(inside.size());
  bool any = false;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    outside[i] = inside[i] == 0 ? 1 : 0;
    any = any || outside[i] != 0;
  }
  if (!any) return std::vector<float>(inside.size(), 1.0F);
  std::vector<float> distance = distance_transform(grid.size, grid.spacing, outside);
  double shortest = grid.spacing.x();
  for (int a = 0; a < 3; ++a)
    if (grid.size[a] > 1) shortest = std::min(shortest, grid.spacing[a]);
  std::array<double, 3> sd{};
  for (int a = 0; a < 3; ++a) sd[static_cast<std::size_t>(a)] = shortest / grid.spacing[a];
  gaussian_blur(distance, grid.size, sd);
  return distance;
}

}  // namespace

std::vector<std::int32_t> distance_basins(const std::vector<std::uint8_t>& inside, const Grid& grid) {
  const std::vector<float> height = smooth_distance(inside, grid);
  const std::vector<Step> steps = steps_of(grid);
  const Index nx = grid.size[0], ny = grid.size[1];
  std::vector<Index> up(inside.size());
  parallel_for(std::ssize(inside), 1 << 14, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      up[i] = i;
      if (inside[i] == 0) continue;
      const std::array<Index, 3> at{i % nx, i / nx % ny, i / (nx * ny)};
      for (const Step& step : steps) {
        bool there = true;
        for (std::size_t a = 0; a < 3; ++a)
          there = there && at[a] + step.by[a] >= 0 && at[a] + step.by[a] < grid.size[a];
        const Index next = i + step.offset;
        if (!there || inside[next] == 0) continue;
        // Of equal heights the later voxel is above.
        if (height[next] > height[up[i]] || (height[next] == height[up[i]] && next > up[i])) up[i] = next;
      }
    }
  });
  std::vector<std::int32_t> labels(inside.size(), 0);
  std::int32_t count = 0;
  std::vector<Index> path;
  for (Index i = 0; i < std::ssize(inside); ++i) {
    if (inside[i] == 0) continue;
    path.clear();
    Index top = i;
    for (; labels[top] == 0 && up[top] != top; top = up[top]) path.push_back(top);
    if (labels[top] == 0) labels[top] = ++count;
    for (const Index voxel : path) labels[voxel] = labels[top];
  }
  return labels;
}

}  // namespace csrbf
