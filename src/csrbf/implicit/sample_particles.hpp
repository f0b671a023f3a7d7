#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"

namespace csrbf {

struct ParticleOptions {
  double spacing = 0.03;     ///< about the distance between neighbours, as a fraction of the diagonal of field.bounds()
  double level = 0;          ///< particles live on f = level
  Points<3> seeds{3, 0};     ///< where the first particles are, 3 x n; default: the field's
  int iterations = 1000;     ///< at most; ends earlier when no particle splits, dies or moves any more
  std::uint64_t random = 7;  ///< directions in which particles split
  Progress progress{};       ///< stage "particles"
};

/// Points spread evenly over a surface.
struct Particles {
  Points<3> points;
  Points<3> normals;       ///< outward unit normals
  int iterations = 0;      ///< used
  bool converged = false;  ///< at rest before the last iteration
};

/// Samples a surface by particles that repel each other and are constrained to it (Witkin and Heckbert 1994): where
/// there is room they grow and split, where it is crowded they shrink and die, until the surface connected to the seeds
/// is covered. Deterministic. O(n log n) for each iteration, n about area / (0.8 spacing^2).
///
/// Throws InvalidInput for a field without finite bounds, no seeds, seeds or options outside the above, a spacing below
/// 1e-3; SolverFailure if no seed reaches the surface; Cancelled.
Particles sample_particles(const Field<3>& field, const ParticleOptions& options = {});

}  // namespace csrbf
