#include "csrbf/levelset/seeded/nearest_seeds.hpp"

#include "csrbf/spatial/distance_transform.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <queue>

namespace csrbf {
namespace {

double shortest_edge(const Grid& grid) {
  return grid.spacing.head(grid.dimension()).minCoeff();
}

// What a step at each voxel costs for its length: 1 over the distance to what surrounds the group, in voxels of the
// shortest edge. The square of it finds necks as well, but gives most to the deepest seed where there are none.
std::vector<float> step_costs(const Grid& grid, std::span<const std::int32_t> groups) {
  std::vector<std::uint8_t> around(groups.size(), 0);
  const std::array<Index, 3> strides{1, grid.size[0], grid.size[0] * grid.size[1]};
  for (Index i = 0; i < grid.voxels(); ++i) {
    if (groups[i] < 0) around[i] = 1;
    for (int a = 0; a < grid.dimension(); ++a) {
      const Index next = i + strides[a];
      if (i / strides[a] % grid.size[a] + 1 == grid.size[a] || groups[i] == groups[next]) continue;
      if (groups[i] >= 0 && groups[next] >= 0) around[i] = around[next] = 1;  // groups that touch
    }
  }
  std::vector<float> costs = distance_transform(grid.size, grid.spacing, around);
  const auto edge = static_cast<float>(shortest_edge(grid));
  const auto longest = static_cast<float>(*std::max_element(grid.size.begin(), grid.size.end()));
  for (float& each : costs) each = 1 / std::clamp(each / edge, 0.5F, longest);
  return costs;
}

// All voxels that share a corner, and how far they are.
template <class Use>
void for_neighbours(const Grid& grid, Index i, const Use& use) {
  const auto [nx, ny, nz] = grid.size;
  const Index x = i % nx, y = i / nx % ny, z = i / (nx * ny);
  for (Index w = std::max<Index>(0, z - 1); w <= std::min(nz - 1, z + 1); ++w)
    for (Index v = std::max<Index>(0, y - 1); v <= std::min(ny - 1, y + 1); ++v)
      for (Index u = std::max<Index>(0, x - 1); u <= std::min(nx - 1, x + 1); ++u) {
        const Point<3> step(static_cast<double>(u - x), static_cast<double>(v - y), static_cast<double>(w - z));
        if (!step.isZero()) use(grid.index(u, v, w), static_cast<float>(step.cwiseProduct(grid.spacing).norm()));
      }
}

// Groups in which a border may move through more than all that a label has.
std::set<std::int32_t> open_groups(const Grid& grid, std::span<const std::int32_t> groups,
                                   std::span<const std::uint8_t> seeds, std::span<const std::uint8_t> labels) {
  std::vector<std::uint8_t> marked(groups.size(), 0);
  for (std::size_t i = 0; i < marked.size(); ++i) marked[i] = groups[i] >= 0 && seeds[i] != 0 ? 1 : 0;
  const std::vector<float> distance = distance_transform(grid.size, grid.spacing, marked);
  std::map<std::pair<std::int32_t, std::uint8_t>, std::array<double, 2>> volumes;  // that of the border's way, and all
  const std::array<Index, 3> strides{1, grid.size[0], grid.size[0] * grid.size[1]};
  for (Index i = 0; i < grid.voxels(); ++i) {
    if (groups[i] < 0) continue;
    volumes[{groups[i], labels[i]}][1] += 1;
    for (int a = 0; a < grid.dimension(); ++a) {
      const Index next = i + strides[a];
      if (i / strides[a] % grid.size[a] + 1 == grid.size[a] || groups[i] != groups[next] || labels[i] == labels[next])
        continue;
      const double way = 0.5 * static_cast<double>(distance[i] + distance[next]) / grid.spacing[a];
      volumes[{groups[i], labels[i]}][0] += way;
      volumes[{groups[i], labels[next]}][0] += way;
    }
  }
  std::set<std::int32_t> open;
  for (const auto& [of, volume] : volumes)
    if (volume[0] > volume[1]) open.insert(of.first);
  return open;
}

// By the algorithm of Dijkstra.
void spread_seeds(const Grid& grid, std::span<const std::int32_t> groups, std::span<const std::uint8_t> seeds,
                  std::span<std::uint8_t> labels) {
  const std::vector<float> costs = step_costs(grid, groups);
  std::vector<float> distance(groups.size(), std::numeric_limits<float>::infinity());
  using Reached = std::pair<float, Index>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> queue;
  for (Index i = 0; i < grid.voxels(); ++i) {
    if (groups[i] < 0 || seeds[i] == 0) continue;
    distance[i] = 0;
    labels[i] = seeds[i] - 1;
    queue.emplace(0.0F, i);
  }
  while (!queue.empty()) {
    const float reached = queue.top().first;
    const Index i = queue.top().second;
    queue.pop();
    if (reached > distance[i]) continue;
    for_neighbours(grid, i, [&](Index j, float length) {
      const float there = reached + 0.5F * length * (costs[i] + costs[j]);
      if (groups[j] != groups[i] || there >= distance[j]) return;
      distance[j] = there;
      labels[j] = labels[i];
      queue.emplace(there, j);
    });
  }
}

}  // namespace

std::set<std::int32_t> nearest_seeds(const Grid& grid, std::span<const std::int32_t> groups,
                                     std::span<const std::uint8_t> seeds, std::span<std::uint8_t> labels) {
  std::vector<std::uint8_t> found(labels.begin(), labels.end());
  spread_seeds(grid, groups, seeds, found);
  std::set<std::int32_t> open = open_groups(grid, groups, seeds, found);
  for (std::size_t i = 0; i < found.size(); ++i)
    if (groups[i] >= 0 && !open.contains(groups[i])) labels[i] = found[i];
  return open;
}

}  // namespace csrbf
