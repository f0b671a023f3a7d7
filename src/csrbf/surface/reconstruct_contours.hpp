#pragma once

#include "csrbf/surface/reconstruct.hpp"

namespace csrbf {

/// How reconstruct_contours() turns contours into a surface. Lengths are relative to the data.
struct ContourOptions {
  /// Largest number of basis functions of the spline, two per contour point; time grows with its third power. The
  /// remaining contour points are met by corrections.
  Index centers = 2000;
  /// lambda of the spline: 0 meets every contour; 1e-4 to 1e-2 smooths contours that are misaligned by about a percent
  /// of the diagonal, as when a patient breathes between slices. Not set: 1e-3 for jagged contours, such as those
  /// traced from pixels, else 0.
  std::optional<double> smoothing = {};
  Progress progress = {};  ///< stages "farthest points", "fit"
};

/// A smooth closed surface through contours drawn on slices: closed planar curves. The planes need not be evenly
/// spaced or parallel (short and long axis views of a heart can be combined). Inside is determined by the even-odd
/// rule: a curve within another one is a hole. The number of curves may change from slice to slice: surfaces branch,
/// merge and end.
///
/// Between slices the surface is that of a triharmonic spline (see fit_contours()), smooth across them. Where all
/// contours of a stack of parallel slices end, the surface continues smoothly and closes within one more spacing, if it
/// can; otherwise it is cut off by a flat cap with a rounded rim: half a spacing beyond the last slice where the
/// cross-section does not shrink, further out where it does. Without smoothing the surface interpolates the contours.
///
/// `contours`: curves given by their edges, two per vertex; open ones are closed by a straight segment. In the result
/// `source` has the vertices of the contours, in order along each, and `normals` those of the surface there. The result
/// is equivariant under rotation, translation and scaling.
///
/// Throws InvalidInput for bad options, coordinates that are not finite, vertices with more than two edges, contours
/// that are not planar or enclose nothing, and fewer than two slices; SolverFailure if no surface is found.
Reconstruction reconstruct_contours(const Polylines& contours, const ContourOptions& options = {});

}  // namespace csrbf
