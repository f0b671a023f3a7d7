#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/levelset/segment_options.hpp"

#include <memory>
#include <vector>

namespace csrbf {

struct FiniteDifferenceOptions {
  /// Weight of the length (area) of the contour relative to the largest force, in edges of the shortest voxel side.
  double length = 0;
  double band = 6;             ///< half width of the narrow band in shortest edges, at least 3; 0: the whole image
  int reinitialize_every = 5;  ///< steps; 0: never, for which `penalty` is made
  double penalty = 0;          ///< of |grad f| other than 1, eq. (7.18), relative to the largest force and in edges
  int iterations = 1000;       ///< at most
  /// Converged when no more than this share of the voxels changed labels within 20 iterations.
  double tolerance = 1e-4;
  Progress progress = {};  ///< stage "evolve"
};

template <int Dim>
struct FiniteDifferenceResult {
  /// Interpolates the final values at the voxels, clipped at 3 edges, by a Wendland function each.
  std::shared_ptr<const Field<Dim>> field;
  std::vector<float> values;          ///< at the voxels: about the signed distance, in the unit of the spacing
  std::vector<unsigned char> labels;  ///< 1 where they are positive
  int iterations = 0;
  bool converged = false;
  std::vector<Index> changes;  ///< labels that changed in each iteration
  std::vector<double> gaps;    ///< as in CollocationResult
};

/// The dense baseline that level sets by CSRBFs are compared with: f_t = -V |grad f| + length |grad f| div(grad f /
/// |grad f|) on the voxels, V the force over its largest size, from the signed distance to the boundary of the labels
/// `start` (1 inside): upwind differences, reinitialisation, narrow band (see DenseLevelSet). The contour moves at most
/// half a voxel in an iteration and new ones do not appear: the start must touch every part of the object.
///
/// Throws InvalidInput for options out of range, an image of another dimension and a start of one label only;
/// Cancelled.
template <int Dim>
FiniteDifferenceResult<Dim> finite_difference(const Grid& grid, const unsigned char* start, const ForceUpdate& force,
                                              const FiniteDifferenceOptions& options = {});

}  // namespace csrbf
