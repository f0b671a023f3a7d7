#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/surface/reconstruct.hpp"

#include <optional>

namespace csrbf {

/// How reconstruct_contours() turns contours into a surface. Lengths are relative to the data.
struct ContourOptions {
  /// Budget of basis functions of the spline, two for a contour point; the time grows with its third power. Contour
  /// points beyond it are met by corrections.
  Index centers = 2000;
  /// lambda of the spline: 0 meets every contour; 1e-4 to 1e-2 smooth contours that do not fit together by about a
  /// percent of the diagonal, as when a patient breathes between the slices. Not set: 1e-3 for contours in zigzag, as
  /// those traced from pixels, else 0.
  std::optional<double> smoothing = {};
  Progress progress = {};  ///< stages "farthest points", "fit"
};

/// A smooth closed surface through contours that were drawn on slices: closed curves, of which each lies in a plane.
/// The planes need not be evenly spaced, nor parallel (short and long axis views of a heart together). What the curves
/// of a plane enclose is where an odd number of them is around a place: a curve within another one is a hole. The
/// number of curves may change from slice to slice: surfaces branch, merge and end.
///
/// Between slices the surface is that of a triharmonic spline (see fit_contours()), smooth across them. Where all
/// contours of a stack of parallel slices end, it goes on as it came and closes within one more spacing, if it can;
/// otherwise it is cut off by a flat cap with a rounded rim: half a spacing beyond the last slice where the
/// cross-section does not get smaller, further beyond where it does. Without smoothing the contours themselves are met.
///
/// `contours`: curves by their edges, each vertex with two; open ones are closed by a straight segment. In the result
/// `source` are the vertices of contours in their order along them and `normals` those of the surface there. The result
/// turns, moves and scales with the contours.
///
/// Throws InvalidInput for bad options, coordinates that are not finite, vertices with more than two edges, contours
/// that are not flat or enclose nothing, and fewer than two slices; SolverFailure when no surface comes out.
Reconstruction reconstruct_contours(const Polylines& contours, const ContourOptions& options = {});

}  // namespace csrbf
