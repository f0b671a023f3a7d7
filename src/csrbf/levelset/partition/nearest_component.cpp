#include "csrbf/levelset/partition/nearest_component.hpp"

#include "csrbf/levelset/regions/label_runs.hpp"

#include <cmath>

namespace csrbf {

VoxelComponents voxel_components(std::span<const std::uint8_t> labels, std::uint8_t label, const Grid& grid) {
  LabelRuns runs(labels, grid);
  const LabelRuns::Parts parts = runs.parts(label);
  VoxelComponents result{std::vector<std::int32_t>(labels.size(), -1), parts.count};
  for (std::size_t row = 0; row + 1 < runs.first.size(); ++row)
    for (std::size_t i = runs.first[row]; i < runs.first[row + 1]; ++i) {
      const auto at = result.component.begin() + static_cast<std::ptrdiff_t>(row) * grid.size[0];
      if (parts.of_run[i] >= 0) std::fill(at + runs.runs[i].begin, at + runs.runs[i].end, parts.of_run[i]);
    }
  return result;
}

// Steps along the axes to the nearest voxel of the label: each is first or last reached along an axis, so that a sweep
// in the order of the voxels and one back find them all.
VoxelComponents nearest_components(std::span<const std::uint8_t> labels, std::uint8_t label, const Grid& grid) {
  VoxelComponents result = voxel_components(labels, label, grid);
  std::vector<std::int32_t>& component = result.component;
  if (result.count == 0) {
    component.assign(labels.size(), 0);
    result.count = 1;
    result.steps.assign(labels.size(), 0);
    return result;
  }
  const auto [nx, ny, nz] = grid.size;
  constexpr std::int32_t far = 1 << 30;
  std::vector<std::int32_t>& steps = result.steps;
  steps.resize(labels.size());
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = component[i] >= 0 ? 0 : far;
  const auto take = [&](Index to, Index from) {
    if (steps[from] + 1 >= steps[to]) return;
    steps[to] = steps[from] + 1;
    component[to] = component[from];
  };
  for (Index z = 0; z < nz; ++z)
    for (Index y = 0; y < ny; ++y) {
      const Index begin = nx * (y + ny * z);
      for (Index i = begin; i < begin + nx; ++i) {
        if (i > begin) take(i, i - 1);
        if (y > 0) take(i, i - nx);
        if (z > 0) take(i, i - nx * ny);
      }
    }
  for (Index z = nz; z-- > 0;)
    for (Index y = ny; y-- > 0;) {
      const Index begin = nx * (y + ny * z);
      for (Index i = begin + nx; i-- > begin;) {
        if (i + 1 < begin + nx) take(i, i + 1);
        if (y + 1 < ny) take(i, i + nx);
        if (z + 1 < nz) take(i, i + nx * ny);
      }
    }
  return result;
}

std::vector<bool> stand_out(const VoxelComponents& nearest, std::span<const float> values,
                            std::span<const std::uint8_t> mask, std::span<const double> means, double step) {
  constexpr std::int32_t beside = 3;  // steps; by hand: 1 to 3 tell the same
  std::vector<Index> excess(nearest.count, 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (nearest.steps[i] == 0 || nearest.steps[i] > beside || (!mask.empty() && mask[i] == 0)) continue;
    const auto c = static_cast<std::size_t>(nearest.component[i]);
    excess[c] += (means[c] - static_cast<double>(values[i]) - step) * step > 0 ? 1 : -1;
  }
  std::vector<bool> result(nearest.count);
  for (std::size_t c = 0; c < result.size(); ++c) result[c] = excess[c] >= 0;
  return result;
}

void drop_parts(std::span<const float> force, const Grid& grid, const ContourWeight& weight, double place_price,
                std::span<std::uint8_t> labels) {
  const Index nx = grid.size[0], nxy = nx * grid.size[1], rows = grid.size[1] * grid.size[2];
  const auto squared = [&](std::size_t axis) { return weight.along[axis] * weight.along[axis]; };
  for (const std::uint8_t label : {std::uint8_t{1}, std::uint8_t{0}}) {
    const VoxelComponents parts = voxel_components(labels, label, grid);
    if (parts.count < 2) continue;
    std::vector<double> gain(parts.count, 0);  // of the part being there
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (labels[i] == label) gain[parts.component[i]] += (label == 1 ? -1 : 1) * static_cast<double>(force[i]);
    // The contour, as in contour_price(), of the part of the voxel inside it or next to it.
    for (Index row = 0; row < rows; ++row) {
      const bool y = row % grid.size[1] + 1 < grid.size[1], z = row / grid.size[1] + 1 < grid.size[2];
      for (Index i = row * nx, end = i + nx; i < end; ++i) {
        const std::uint8_t here = labels[i];
        const bool a = i + 1 < end && labels[i + 1] != here, b = y && labels[i + nx] != here,
                   c = z && labels[i + nxy] != here;
        if (!a && !b && !c) continue;
        const Index inside = here == label ? i : a ? i + 1 : b ? i + nx : i + nxy;
        const double squares = (a ? squared(0) : 0) + (b ? squared(1) : 0) + (c ? squared(2) : 0);
        gain[parts.component[inside]] -= weight.length * std::sqrt(squares);
      }
    }
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (labels[i] == label && gain[parts.component[i]] < place_price) labels[i] = 1 - label;
  }
}

}  // namespace csrbf
