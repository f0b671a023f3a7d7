#pragma once

#include "csrbf/core/grid.hpp"

#include <span>

namespace csrbf {

inline constexpr double smooth_reach = 0.1;  ///< of a smooth mean; by hand

/// A mean that varies slowly, as light does: in up to twelve rounds, as many as make the values shortest to describe,
/// the local mean of what it leaves is added to it (Tukey's twicing), by about a Gaussian whose standard deviation is
/// `reach` of the longest side. Fitted on blocks that are small beside that, and linear between their centres. Replaces
/// `values`, which are 0 where the `weights` (0 or 1) are; far from weights it is 0. `grain`: voxels that are as one to
/// noise. Returns how many numbers, told as exactly as the values allow, cost as much as such a mean. O(voxels).
double smooth_mean(std::span<const float> weights, std::span<float> values, const Grid& grid, double grain = 1,
                   double reach = smooth_reach);

}  // namespace csrbf
