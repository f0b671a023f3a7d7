#include "csrbf/levelset/partition/nearest_component.hpp"

namespace csrbf {
namespace {

// Calls take(neighbour) for the face neighbours of a voxel.
template <class Take>
void for_neighbours(const Grid& grid, Index voxel, const Take& take) {
  const auto [nx, ny, nz] = grid.size;
  const Index x = voxel % nx, y = voxel / nx % ny, z = voxel / (nx * ny);
  if (x > 0) take(voxel - 1);
  if (x + 1 < nx) take(voxel + 1);
  if (y > 0) take(voxel - nx);
  if (y + 1 < ny) take(voxel + nx);
  if (z > 0) take(voxel - nx * ny);
  if (z + 1 < nz) take(voxel + nx * ny);
}

}  // namespace

NearestComponents nearest_components(std::span<const std::uint8_t> labels, std::uint8_t label, const Grid& grid) {
  NearestComponents result;
  std::vector<std::int32_t>& component = result.component;
  component.assign(labels.size(), -1);
  std::vector<std::int32_t> queue;
  queue.reserve(labels.size());
  for (std::size_t seed = 0; seed < labels.size(); ++seed) {
    if (labels[seed] != label || component[seed] >= 0) continue;
    std::size_t head = queue.size();
    component[seed] = static_cast<std::int32_t>(result.count);
    queue.push_back(static_cast<std::int32_t>(seed));
    for (; head < queue.size(); ++head)
      for_neighbours(grid, queue[head], [&](Index next) {
        if (labels[next] != label || component[next] >= 0) return;
        component[next] = static_cast<std::int32_t>(result.count);
        queue.push_back(static_cast<std::int32_t>(next));
      });
    ++result.count;
  }
  if (result.count == 0) {
    component.assign(labels.size(), 0);
    result.count = 1;
    return result;
  }
  // Fronts start from all voxels of all components at once.
  for (std::size_t head = 0; head < queue.size(); ++head)
    for_neighbours(grid, queue[head], [&](Index next) {
      if (component[next] >= 0) return;
      component[next] = component[queue[head]];
      queue.push_back(static_cast<std::int32_t>(next));
    });
  return result;
}

}  // namespace csrbf
