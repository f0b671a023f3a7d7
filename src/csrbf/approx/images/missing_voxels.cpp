#include "csrbf/approx/images/missing_voxels.hpp"

#include "csrbf/core/interruption.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace csrbf {
namespace {

// All chosen by hand. The rim of a hole, whose voxels are samples: large enough for the patches around missing voxels.
constexpr double rim_voxels = 8;     // width
constexpr double rim_depths = 2;     // the same in depths of the deepest hole; the larger one counts
constexpr double useful_share = .5;  // of the known voxels: with more of them in rims all known ones are samples

constexpr double deep = 1.5;  // mean depth of missing voxels, in spacings of known ones, above which they form holes
constexpr double shift_depths = 4;  // how far holes are shifted to test kernels on them, in depths of the deepest one
constexpr Index least_trial_step = 5, most_trial_voxels = 1000;  // of known voxels, to test the fit on

// The missing voxels shifted along an axis, where they land on known ones.
VoxelMask shifted(const VoxelMask& missing, const Grid& grid, int axis, Index by) {
  VoxelMask result(missing.size(), 0);
  Index stride = 1;
  for (int a = 0; a < axis; ++a) stride *= grid.size[a];
  const Index size = grid.size[axis];
  for (std::size_t i = 0; i < missing.size(); ++i) {
    const Index to = static_cast<Index>(i) / stride % size + by;
    const std::size_t target = i + static_cast<std::size_t>(by * stride);
    if (missing[i] != 0 && to >= 0 && to < size && missing[target] == 0) result[target] = 1;
  }
  return result;
}

}  // namespace

// The distance is separable: the minimum along one axis after the other, there and back.
std::vector<float> distance_to(bool wanted, const VoxelMask& mask, const Grid& grid) {
  std::vector<float> distance(mask.size());
  for (std::size_t i = 0; i < mask.size(); ++i)
    distance[i] = (mask[i] != 0) == wanted ? 0 : std::numeric_limits<float>::infinity();
  InterruptionPoint pause(1U << 10);
  Index stride = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Index size = grid.size[axis];
    const auto step = static_cast<float>(grid.spacing[static_cast<Index>(axis)]);
    for (Index line = 0; line < grid.voxels(); line += size * stride) {
      const auto relax = [&](Index to, Index from) {
        pause();
        float* target = distance.data() + line + to * stride;
        const float* source = distance.data() + line + from * stride;
        for (Index k = 0; k < stride; ++k) target[k] = std::min(target[k], source[k] + step);
      };
      for (Index i = 1; i < size; ++i) relax(i, i - 1);
      for (Index i = size - 2; i >= 0; --i) relax(i, i + 1);
    }
    stride *= size;
  }
  return distance;
}

std::vector<int> long_axes(const Grid& grid) {
  std::vector<int> axes;
  for (int a = 0; a < 3; ++a)
    if (grid.size[a] > 1) axes.push_back(a);
  return axes;
}

double mean_spacing(const Grid& grid) {
  const std::vector<int> axes = long_axes(grid);
  double product = 1;
  for (const int a : axes) product *= grid.spacing[a];
  return axes.empty() ? 1 : std::pow(product, 1 / static_cast<double>(axes.size()));
}

double rim_of(const VoxelMask& missing, const Grid& grid) {
  const std::vector<float> to_known = distance_to(false, missing, grid);
  const double depth = *std::max_element(to_known.begin(), to_known.end());
  return std::max(rim_voxels * mean_spacing(grid), rim_depths * depth);
}

std::vector<Index> sample_voxels(const VoxelMask& missing, const Grid& grid, Index known) {
  const auto rim = static_cast<float>(rim_of(missing, grid));
  const std::vector<float> to_missing = distance_to(true, missing, grid);
  std::vector<Index> near, all;
  all.reserve(known);
  for (std::size_t i = 0; i < missing.size(); ++i) {
    if (missing[i] != 0) continue;
    all.push_back(static_cast<Index>(i));
    if (to_missing[i] <= rim) near.push_back(static_cast<Index>(i));
  }
  return static_cast<double>(near.size()) < useful_share * static_cast<double>(known) ? near : all;
}

std::vector<Index> marked(const VoxelMask& mask) {
  std::vector<Index> voxels;
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[i] != 0) voxels.push_back(static_cast<Index>(i));
  return voxels;
}

VoxelMask trial_holes(const VoxelMask& missing, const Grid& grid, Index known) {
  const std::vector<float> depth = distance_to(false, missing, grid);
  const double sum = std::accumulate(depth.begin(), depth.end(), 0.0);
  const auto voxels = static_cast<double>(missing.size());
  const std::vector<int> axes = long_axes(grid);
  const double spacing = mean_spacing(grid) * std::pow(voxels / static_cast<double>(known),
                                                       1 / static_cast<double>(std::max<std::size_t>(1, axes.size())));
  if (!(sum > deep * spacing * (voxels - static_cast<double>(known)))) return {};
  const double distance = shift_depths * *std::max_element(depth.begin(), depth.end());
  std::vector<VoxelMask> trials;
  for (const int axis : axes)
    for (const double sign : {1.0, -1.0}) {
      VoxelMask trial =
          shifted(missing, grid, axis, static_cast<Index>(std::lround(sign * distance / grid.spacing[axis])));
      if (std::count(trial.begin(), trial.end(), 1) > 0) trials.push_back(std::move(trial));
    }
  if (trials.empty()) return {};
  std::sort(trials.begin(), trials.end(), [](const VoxelMask& a, const VoxelMask& b) {
    return std::count(a.begin(), a.end(), 1) > std::count(b.begin(), b.end(), 1);
  });
  // One direction may meet the background only. The others join as far as they leave room around the holes before.
  VoxelMask holes = std::move(trials.front());
  for (std::size_t t = 1; t < trials.size(); ++t) {
    const std::vector<float> room = distance_to(true, holes, grid);
    for (std::size_t i = 0; i < holes.size(); ++i)
      if (trials[t][i] != 0 && room[i] > distance / 2) holes[i] = 1;
  }
  return holes;
}

VoxelMask trial_voxels(const std::vector<Index>& known, std::size_t voxels) {
  VoxelMask hidden(voxels, 0);
  const Index n = std::ssize(known), step = std::max(least_trial_step, n / most_trial_voxels);
  for (Index run = 0; run + step <= n; run += step) hidden[known[run + run / step * 7919 % step]] = 1;
  return hidden;
}

VoxelMask grown(VoxelMask mask, const Grid& grid, Index reach) {
  Index stride = 1;
  for (const int a : {0, 1, 2}) {
    const Index size = grid.size[a];
    const VoxelMask before = mask;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (before[i] == 0) continue;
      const Index at = static_cast<Index>(i) / stride % size;
      for (Index to = std::max<Index>(0, at - reach); to <= std::min(size - 1, at + reach); ++to)
        mask[i + static_cast<std::size_t>((to - at) * stride)] = 1;
    }
    stride *= size;
  }
  return mask;
}

}  // namespace csrbf
