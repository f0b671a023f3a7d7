#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"

namespace csrbf {

struct ParticleOptions {
  /// Approximate distance between neighbours, as a fraction of the diagonal of field.bounds(), 0.001 to 1.
  double spacing = 0.03;
  double level = 0;          ///< particles lie on f = level
  Points<3> seeds{3, 0};     ///< where the first particles are, 3 x n; default: the seeds of the field
  int iterations = 1000;     ///< at most; fewer if no particle splits, dies or moves any more
  std::uint64_t random = 7;  ///< seed for the directions in which particles split
  Progress progress{};       ///< stage "particles"
};

/// Points spread evenly over a surface.
struct Particles {
  Points<3> points;
  Points<3> normals;       ///< outward unit normals
  int iterations = 0;      ///< used
  bool converged = false;  ///< whether particles came to rest before the last iteration
};

/// Samples a surface by particles that repel each other and stay on it (Witkin and Heckbert 1994). They grow and split
/// where there is room, and shrink and die where it is crowded, until they cover the surface connected to the seeds.
/// Deterministic. O(n log n) per iteration, with n about area / (0.8 spacing^2).
///
/// Throws InvalidInput for a field without finite bounds, no seeds, and options out of range; SolverFailure if no seed
/// reaches the surface; Cancelled.
Particles sample_particles(const Field<3>& field, const ParticleOptions& options = {});

}  // namespace csrbf
