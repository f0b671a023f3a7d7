#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/levelset/evolve.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace csrbf {

/// Source of the costs of regions; see RegionForces.
struct ForceSource {
  int regions = 2;
  /// Statistics from labels; false when there are none to update.
  std::function<bool(std::span<const std::uint8_t> labels)> fit;
  /// Back to the statistics before the last fit.
  std::function<void()> undo;
  /// Writes the cost of region k against the others, over `scale`; returns the sum of the least costs of the others.
  std::function<double(int k, double scale, std::span<float> force)> force;
  std::span<const float> prior = {};  ///< as in SegmentOptions

  /// force() and the prior, whose unit is the scale; returns the sum over `scale`.
  double force_with_prior(int k, double scale, std::span<float> to) const;
};

struct VariationalResult {
  std::vector<std::vector<float>> coefficients;  ///< one level set for two regions (inside: label 1), else one of each
  std::vector<std::uint8_t> labels;
  int iterations = 0;
  bool converged = false;
  std::vector<double> energy;  ///< as in SegmentReport
};

struct VariationalOptions {
  double smoothness = 0;    ///< weight of the length of the contour, in voxels
  double noise = 0;         ///< ForceNoise::size
  int iterations = 100;     ///< at most; of descend_locally ten times as many, as its steps are small
  bool fill_holes = false;  ///< of descend_locally: what the contour encloses gets label 1
  Progress progress = {};   ///< stage "evolve"
};

/// How noisy a force is.
struct ForceNoise {
  double size = 0;   ///< standard deviation over the difference of the means in the two regions
  double grain = 1;  ///< 1: from voxel to voxel; up to 3 where neighbours are alike, as in speckle
};

/// From second differences of neighbours along x, and of voxels further apart inside the regions. A large size says
/// that single voxels cannot tell the regions apart; it is 1 when the force contradicts the labels.
ForceNoise force_noise(std::span<const float> force, std::span<const std::uint8_t> labels,
                       std::span<const std::uint8_t> mask, const Grid& grid);

/// The center spacing for that noise.
double choose_center_spacing(const ForceNoise& noise, int dimension);

/// Statistics and contours in turns, everywhere at once, from `labels`.
template <int Dim>
VariationalResult descend_globally(const Lattice<Dim>& lattice, const ForceSource& source,
                                   const VariationalOptions& options, std::vector<std::uint8_t> labels);

/// The contour moves from the border of `labels` as far as the energy falls, a few voxels in each step. `weights` of
/// the length: one per voxel, or none.
template <int Dim>
VariationalResult descend_locally(const Lattice<Dim>& lattice, const ForceSource& source,
                                  const VariationalOptions& options, const Grid& grid,
                                  std::vector<std::uint8_t> labels);

}  // namespace csrbf
