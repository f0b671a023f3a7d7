#pragma once

#include "csrbf/levelset/contour/contour_energy.hpp"
#include "csrbf/levelset/contour/variational.hpp"

namespace csrbf {

/// 1 where an image is flat, towards 0 where its gradient is large: 1 / (1 + (|grad I| / k)^2), k a quarter of the 99th
/// percentile of |grad I|, of the image smoothed over about two voxels. O(n).
std::vector<float> edge_weights(std::span<const float> values, const Grid& grid);

struct EdgeFlowOptions {
  double smoothness = 1;                     ///< weight of the length of the contour
  double balloon = 0;                        ///< pressure in [-1, 1] towards growth (> 0) or shrinking
  std::span<const std::uint8_t> mask = {};   ///< 0 in voxels that the contour must stay out of; one per voxel, or none
  int iterations = 100;                      ///< steps: at most ten times as many
  bool fill_holes = false;                   ///< what the contour encloses gets label 1
  Progress progress = {};                    ///< stage "evolve"
  std::span<const std::uint8_t> seeds = {};  ///< holes with a seed of the background (1) stay; one per voxel, or none
};

/// Geodesic active contour on the lattice: the signed distance f near the contour follows
///
///     f_t = smoothness (g Laplacian f + <grad g, grad f>) + balloon g
///
/// with g = edge_weights(): it shortens where the image is flat, is drawn to edges from both sides and, for balloon >
/// 0, grows towards them. Each step moves the target of the voxels within three of the contour and fits the
/// coefficients to it. Ends where the energy smoothness int g - balloon int_inside g falls no further; the result is
/// its least.
template <int Dim>
VariationalResult descend_to_edges(const Lattice<Dim>& lattice, const EdgeFlowOptions& options, const Grid& grid,
                                   std::span<const float> g, std::vector<std::uint8_t> labels);

}  // namespace csrbf
