#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/core/progress.hpp"

namespace csrbf {

/// How a contour that leaves the box ends.
enum class ContourEnds {
  closed,  ///< it continues along the border of the box, so that every line is the outline or a hole of a region
  open,    ///< it ends there
};

struct ContourLinesOptions {
  /// Cells along the longest side of the box, 1 ... 16384; 0 = automatic_resolution(field).
  int resolution = 0;
  /// The contour f = level is extracted.
  double level = 0;
  /// The box searched; its sides are divided into equal parts so that cells are as close to squares as possible.
  /// Default (an empty box): the field's bounds.
  Box<2> bounds{};

  ContourEnds ends = ContourEnds::closed;

  Progress progress{};  ///< stage "contour lines"
};

/// A sequence of points, with the inside (f >= level) on the left of each segment.
struct ContourLine {
  Index begin = 0;     ///< its first point
  Index size = 0;      ///< number of its points
  bool closed = true;  ///< the last point is joined to the first
  double area = 0;     ///< within a closed line: positive around a region, negative around a hole
};

/// The lines of a contour, with length and area.
struct ContourLines {
  Points<2> points{2, 0};          ///< line after line
  std::vector<ContourLine> lines;  ///< ordered by their lowest points
  double length = 0;               ///< of the contour, without segments along the border of the box
  double area = 0;                 ///< of the part of the box with f >= level
  double length_error = 0;         ///< estimates of the errors of both
  double area_error = 0;
};

/// Cells along the longest side that resolve the field: cells as long as its feature size, between 32 and 2048
/// of them; 256 if the field does not know it.
int automatic_resolution(const Field<2>& field);

/// The curves f = level in the plane, with points on them to about 1e-7 of a cell: marching squares, with the
/// asymptotic decider where all four edges of a cell are crossed (Nielson and Hamann 1991), then Newton's method along
/// the crossed edges, safeguarded by a bracket. No line if nothing of the box is inside; closed lines never cross.
///
/// `length` and `area` are those of cubic arcs through the points, perpendicular to the gradients there (Hermite
/// interpolation): on smooth contours their errors decrease with the fourth power of the cell. The arcs add to the
/// polygons the term of second order; the sum of its magnitudes estimates the error: too large for arcs, correct for
/// polygons of the points. Features thinner than a cell may be lost, and are then not in the estimate.
///
/// One value for each corner of a cell, about three gradients for each point; 16 bytes for each corner. Bit-identical
/// for any number of threads. Throws InvalidInput for a resolution, level or bounds outside the above; SolverFailure if
/// the field is not finite where it is evaluated (with the position); Cancelled.
ContourLines contour_lines(const Field<2>& field, const ContourLinesOptions& options = {});

/// The lines as curves in space: point (x, y) becomes placement * (x, y, 0, 1). Vertex property `contour` (int): the
/// number of the line.
Polylines to_polylines(const ContourLines& contours,
                       const Eigen::Matrix<double, 3, 4>& placement = Eigen::Matrix<double, 3, 4>::Identity());

}  // namespace csrbf
