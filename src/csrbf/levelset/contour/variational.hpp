#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/levelset/contour/contour_energy.hpp"
#include "csrbf/levelset/regions/force_source.hpp"

#include <span>
#include <vector>

namespace csrbf {

struct VariationalOptions {
  double smoothness = 0;                     ///< weight of the length of the contour, in voxels
  double noise = 0;                          ///< ForceNoise::size
  int iterations = 100;                      ///< at most; of descend_locally ten times as many, as its steps are small
  bool fill_holes = false;                   ///< of descend_locally: what the contour encloses gets label 1
  Progress progress = {};                    ///< stage "evolve"
  std::span<const std::uint8_t> mask = {};   ///< of descend_locally: 0 in voxels that stay outside; may be empty
  std::span<const std::uint8_t> seeds = {};  ///< holes with a seed of the background (1) stay; may be empty
};

struct VariationalResult {
  std::vector<std::vector<float>> coefficients;  ///< one level set for two regions (inside: label 1), else one of each
  std::vector<std::uint8_t> labels;
  int iterations = 0;
  bool converged = false;
  std::vector<double> energy;  ///< as in SegmentReport
};

/// Alternates between statistics and contours over the whole image, from `labels`.
template <int Dim>
VariationalResult descend_globally(const Lattice<Dim>& lattice, ForceSource& source, const VariationalOptions& options,
                                   std::vector<std::uint8_t> labels);

/// Moves the contour from the border of `labels` while the energy falls, a few voxels in each step.
template <int Dim>
VariationalResult descend_locally(const Lattice<Dim>& lattice, ForceSource& source, const VariationalOptions& options,
                                  const Grid& grid, std::vector<std::uint8_t> labels);

}  // namespace csrbf
