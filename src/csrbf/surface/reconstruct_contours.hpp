#pragma once

#include "csrbf/surface/reconstruct.hpp"

namespace csrbf {

/// How reconstruct_contours() turns contours into a surface. Lengths are relative to the data.
struct ContourOptions {
  /// Largest number of basis functions of the spline, at least 16; a contour point needs two. Time grows with the third
  /// power. Corrections meet the other contour points.
  Index centers = 2000;
  /// Smoothing of the spline, lambda. 0 meets every contour; 1e-4 to 1e-2 smooths contours that are misaligned by about
  /// one percent of the diagonal, for example because a patient breathes. Unset: 1e-3 for jagged contours, such as
  /// those traced from pixels, else 0.
  std::optional<double> smoothing = {};
  Progress progress = {};  ///< stages "farthest points", "fit"
};

/// Makes a smooth closed surface through contours: closed planar curves drawn on slices. The planes need be neither
/// evenly spaced nor parallel: short and long axis views of a heart can be combined. What is inside follows from the
/// even-odd rule: a curve within another one is a hole. The number of curves may change from slice to slice: surfaces
/// branch, merge and end.
///
/// Between slices the surface is a triharmonic spline, smooth across the slices. Without smoothing it interpolates the
/// contours. Where all contours of a stack of parallel slices end, the surface continues smoothly and closes within one
/// more spacing, if it can. Otherwise it gets a flat cap with a rounded rim: half a spacing beyond the last slice if
/// the cross-section does not shrink there, farther out if it does.
///
/// `contours`: curves given by their edges, two per vertex; open curves are closed by a straight segment. In the result
/// `source` has the vertices of the contours, in order along each one, and `normals` those of the surface there. The
/// result rotates, moves and scales with the contours.
///
/// Throws InvalidInput for bad options, coordinates that are not finite, vertices with more than two edges, contours
/// that are not planar or enclose nothing, and fewer than two slices; SolverFailure if no surface is found; Cancelled.
Reconstruction reconstruct_contours(const Polylines& contours, const ContourOptions& options = {});

}  // namespace csrbf
