#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/levelset/segment_options.hpp"

#include <memory>
#include <vector>

namespace csrbf {

struct FiniteDifferenceOptions {
  /// Weight of the contour length (3D: area) relative to the largest force, in edges of the shortest voxel side.
  double length = 0;
  double band = 6;             ///< half width of the narrow band, in shortest edges, at least 3; 0: the whole image
  int reinitialize_every = 5;  ///< steps; 0: never, which needs band 0; use `penalty` then
  double penalty = 0;          ///< on |grad f| other than 1, eq. (7.18), relative to the largest force and in edges
  int iterations = 1000;       ///< at most
  /// Converged if at most this share of the voxels changes labels within 20 iterations.
  double tolerance = 1e-4;
  Progress progress = {};  ///< stage "evolve"
};

template <int Dim>
struct FiniteDifferenceResult {
  /// Interpolates the final values, clipped at 3 edges, with one Wendland function per voxel.
  std::shared_ptr<const Field<Dim>> field;
  std::vector<float> values;          ///< at the voxels: about the signed distance, in the unit of the spacing
  std::vector<unsigned char> labels;  ///< 1 where they are positive
  int iterations = 0;
  bool converged = false;
  std::vector<Index> changes;  ///< number of labels that changed in each iteration
  std::vector<double> gaps;    ///< as in CollocationResult
};

/// The dense baseline for level sets by CSRBFs: f_t = -V |grad f| + length |grad f| div(grad f / |grad f|) on the
/// voxels, with V the force over its largest absolute value. It starts from the signed distance to the boundary of the
/// labels `start` (1 inside) and uses upwind differences, reinitialisation and a narrow band. The contour moves at most
/// half a voxel per iteration and new contours do not appear: the start must touch every part of the object.
///
/// Throws InvalidInput for options out of range, an image of another dimension, forces that are not finite, and a start
/// with a single label; Cancelled.
template <int Dim>
FiniteDifferenceResult<Dim> finite_difference(const Grid& grid, const unsigned char* start, const ForceUpdate& force,
                                              const FiniteDifferenceOptions& options = {});

}  // namespace csrbf
