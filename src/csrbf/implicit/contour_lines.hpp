#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/core/progress.hpp"

#include <functional>

namespace csrbf {

/// How a contour that leaves the box ends.
enum class ContourEnds {
  closed,  ///< along the border of the box, so that every line is the outline or a hole of a region
  open,    ///< where it leaves the box
};

struct ContourLinesOptions {
  /// Cells along the longest side of the box, 1 to 16384; 0: automatic_resolution(field).
  int resolution = 0;
  /// The contour f = level is extracted.
  double level = 0;
  /// The box to search; its sides are divided into equal parts so that cells are nearly squares. Default (an empty
  /// box): the bounds of the field.
  Box<2> bounds{};

  ContourEnds ends = ContourEnds::closed;

  Progress progress{};  ///< stage "contour lines"
};

/// A sequence of points, with the inside (f >= level) on the left of each segment.
struct ContourLine {
  Index begin = 0;     ///< its first point
  Index size = 0;      ///< number of its points
  bool closed = true;  ///< the last point is joined to the first
  double area = 0;     ///< enclosed by a closed line: positive around a region, negative around a hole
};

/// The lines of a contour, with their length and area.
struct ContourLines {
  Points<2> points{2, 0};          ///< line after line
  std::vector<ContourLine> lines;  ///< ordered by their lowest points
  double length = 0;               ///< of the contour, without segments along the border of the box
  double area = 0;                 ///< of the part of the box with f >= level
  double length_error = 0;         ///< estimates of the errors of length and area
  double area_error = 0;
};

/// Number of cells along the longest side that resolves the field: cells as long as its feature size, but 32 to 2048 of
/// them; 256 if the feature size is unknown.
int automatic_resolution(const Field<2>& field);

/// Finds the curves f = level in the plane, with points on them to about 1e-7 of a cell: by marching squares, with the
/// asymptotic decider where all four edges of a cell are crossed (Nielson and Hamann 1991), then by Newton's method
/// along the crossed edges within a bracket. Closed lines never cross. If nothing in the box is inside, there are no
/// lines.
///
/// `length` and `area` are those of cubic arcs through the points, perpendicular to the gradients there (Hermite
/// interpolation): on smooth contours their errors fall with the fourth power of the cell. The error estimates are sums
/// of the absolute differences between arcs and polygons, which are of second order: too large for the arcs, right for
/// the polygons. Features thinner than a cell may be lost, and are then missing in the estimate.
///
/// Cost: one value and 16 bytes for each corner of a cell, about three gradients for each point. The result is the
/// same, bit for bit, for any number of threads. Throws InvalidInput for options out of range; SolverFailure if the
/// field is not finite where it is evaluated (with the position); Cancelled.
ContourLines contour_lines(const Field<2>& field, const ContourLinesOptions& options = {});

struct LevelLinesOptions {
  /// Levels in ascending order; empty: the multiples of `step` between the values in the box.
  std::vector<double> levels = {};
  /// Positive; 0: 1, 2 or 5 times a power of ten, which makes 4 to 11 of them.
  double step = 0;
  int resolution = 0;  ///< as in ContourLinesOptions
  Box<2> bounds{};     ///< as in ContourLinesOptions

  /// Whether lines are wanted at these points, one answer each; lines end where they are not. Default: everywhere.
  std::function<std::vector<bool>(const PointsRef<2>& points)> wanted = {};

  Progress progress{};  ///< stage "contour lines"
};

/// A line on which f has one value, with higher values on the left of each segment.
struct LevelLine {
  double level = 0;
  bool closed = false;     ///< the last point is joined to the first
  Points<2> points{2, 0};  ///< at least 2
};

/// The contour lines of a map: those of many levels, level after level, from the values at one lattice. Points as exact
/// as those of contour_lines(); lines end at the border of the box. Throws as contour_lines(), and InvalidInput for
/// more than 10000 levels, for levels that are not finite and ascending, and for levels and a step at once.
std::vector<LevelLine> level_lines(const Field<2>& field, const LevelLinesOptions& options = {});

/// The lines as curves in space: a point (x, y) becomes placement * (x, y, 0, 1). The vertex property `contour` (int)
/// is the number of the line.
Polylines to_polylines(const ContourLines& contours,
                       const Eigen::Matrix<double, 3, 4>& placement = Eigen::Matrix<double, 3, 4>::Identity());

/// The same of the contour lines of a map: a point (x, y) becomes (x, y, level).
Polylines to_polylines(const std::vector<LevelLine>& lines);

}  // namespace csrbf
