#include "csrbf/levelset/seeded/necks.hpp"

#include "csrbf/levelset/image/signed_distance.hpp"
#include "csrbf/levelset/partition/nearest_component.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace csrbf {
namespace {

constexpr double neck_part = 3;    // radii of a neck in those of what it joins; by hand
constexpr double neck_size = 0.1;  // voxels of what is cut off in those of what stays, at least; by hand

std::vector<std::uint8_t> deeper_than(std::span<const float> depth, double least) {
  std::vector<std::uint8_t> deep(depth.size());
  std::transform(depth.begin(), depth.end(), deep.begin(),
                 [&](float each) -> std::uint8_t { return static_cast<double>(each) > least ? 1 : 0; });
  return deep;
}

double deepest(std::span<const float> depth) {
  return static_cast<double>(*std::max_element(depth.begin(), depth.end()));
}

// Of the marked voxels those that a ball may have as its centre; where there are none, those nearest to one.
std::vector<std::uint8_t> marked_centers(std::span<const std::uint8_t> deep, std::span<const std::uint8_t> marked,
                                         const Grid& grid, double radius) {
  const auto reached = [&](std::span<const std::uint8_t> from) {
    for (std::size_t i = 0; i < deep.size(); ++i)
      if (deep[i] != 0 && from[i] != 0) return true;
    return false;
  };
  if (reached(marked)) return {marked.begin(), marked.end()};
  return deeper_than(signed_distance(grid, marked.data()), -2 * radius);
}

// Takes the parts that a ball of that radius cannot reach, and are thick, away.
bool cut_necks_of(std::vector<std::uint8_t>& labels, std::span<const std::uint8_t> marked, const Grid& grid,
                  std::span<const float> depth, double radius, double half) {
  const std::vector<std::uint8_t> deep = deeper_than(depth, radius - half);
  const std::vector<std::uint8_t> core = marked_parts(deep, marked_centers(deep, marked, grid, radius), grid);
  if (std::find(core.begin(), core.end(), std::uint8_t{1}) == core.end()) return false;
  const std::vector<float> near = signed_distance(grid, core.data());
  std::vector<std::uint8_t> reached(labels.size()), rest(labels.size());
  double stays = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const bool near_core = static_cast<double>(near[i]) >= -1.01 * radius + half;
    reached[i] = labels[i] != 0 && near_core ? 1 : 0;
    rest[i] = labels[i] != 0 && !near_core ? 1 : 0;
    stays += reached[i];
  }
  const std::vector<float> thickness = signed_distance(grid, rest.data());
  const double least = neck_part * radius - half;
  if (deepest(signed_distance(grid, reached.data())) < least) return false;
  const VoxelComponents parts = voxel_components(rest, 1, grid);
  std::vector<double> thickest(parts.count, 0), sizes(parts.count, 0);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (parts.component[i] < 0) continue;
    const auto part = static_cast<std::size_t>(parts.component[i]);
    thickest[part] = std::max(thickest[part], static_cast<double>(thickness[i]));
    if (marked[i] == 0)
      ++sizes[part];
    else
      sizes[part] = -static_cast<double>(rest.size());  // stays
  }
  bool cut = false;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (parts.component[i] < 0) continue;
    const auto part = static_cast<std::size_t>(parts.component[i]);
    if (thickest[part] < least || sizes[part] < neck_size * stays) continue;
    labels[i] = 0;
    cut = true;
  }
  if (cut) labels = marked_parts(labels, marked, grid);
  return cut;
}

}  // namespace

std::vector<std::uint8_t> marked_parts(std::span<const std::uint8_t> labels, std::span<const std::uint8_t> marked,
                                       const Grid& grid) {
  const VoxelComponents parts = voxel_components(labels, 1, grid), marks = voxel_components(marked, 1, grid);
  std::map<std::array<std::int32_t, 2>, Index> votes;  // of each part of the marked voxels for each part
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (parts.component[i] >= 0 && marks.component[i] >= 0) ++votes[{marks.component[i], parts.component[i]}];
  std::vector<Index> most(marks.count, 0);
  for (const auto& [pair, count] : votes) {
    Index& largest = most[static_cast<std::size_t>(pair[0])];
    largest = std::max(largest, count);
  }
  std::vector<bool> kept(parts.count, false);
  for (const auto& [pair, count] : votes)
    if (count == most[static_cast<std::size_t>(pair[0])]) kept[static_cast<std::size_t>(pair[1])] = true;
  std::vector<std::uint8_t> part(labels.size(), 0);
  for (std::size_t i = 0; i < labels.size(); ++i)
    part[i] = parts.component[i] >= 0 && kept[static_cast<std::size_t>(parts.component[i])] ? 1 : 0;
  return part;
}

double cut_necks(std::vector<std::uint8_t>& labels, std::span<const std::uint8_t> marked, const Grid& grid) {
  const double edge = grid.spacing.head(grid.dimension()).minCoeff(), half = 0.5 * edge;
  double widest = 0;
  for (const double voxels : {1.0, 1.5, 2.0, 3.0, 4.0, 6.0}) {
    const std::vector<float> depth = signed_distance(grid, labels.data());
    if (deepest(depth) < neck_part * voxels * edge - half) break;
    if (cut_necks_of(labels, marked, grid, depth, voxels * edge, half)) widest = voxels * edge;
  }
  return widest;
}

}  // namespace csrbf
