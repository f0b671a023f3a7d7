#pragma once

#include "csrbf/core/grid.hpp"

#include "csrbf/levelset/partition/seed_costs.hpp"
#include "csrbf/levelset/segment_options.hpp"

#include <vector>

namespace csrbf {

/// Of voxels that are known: mean costs of a voxel in the wrong region.
inline constexpr float certain_prior = 10;

/// options.prior, and that the core of the seed is inside: the rest of a seed may be too large.
std::vector<float> seed_prior(const SegmentOptions& options, const Grid& grid);

/// For energies that do not take the cost of seeds themselves: options.prior, to which what keeps the seeds of two
/// regions is added, and, of a contour that moves, seed_prior().
std::vector<float> prior_of_seeds(const SegmentOptions& options, const SeedCosts& seeds, const Grid& grid, bool local);

/// Exchanges the labels of two regions if that brings more of the seeds to their side.
void match_seeds(std::span<const std::uint8_t> seeds, std::span<std::uint8_t> labels);

/// The options for a contour that starts at the seeds of label 1.
SegmentOptions starting_at_seeds(SegmentOptions options);

/// Gives seeds that are certain their labels.
void keep_certain_seeds(const SeedCosts& seeds, std::span<std::uint8_t> labels);

}  // namespace csrbf
