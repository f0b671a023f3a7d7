#pragma once

#include "csrbf/surface/normals/orient_normals.hpp"

namespace csrbf {

template <int Dim>
class KdTree;

/// Orientation of estimated normals.
enum class Orient {
  consistent,  ///< neighbours agree, outward where there is an outside (orient_normals)
  viewpoint,   ///< each towards one point, the scanner
  none         ///< arbitrary
};

struct NormalOptions {
  /// Number of points, itself included, that each normal is estimated from, at least 3; 0 chooses one number for the
  /// cloud: 16 for clean data, up to 512 under noise, fewer where they would reach another sheet.
  Index neighbors = 0;
  Orient orient = Orient::consistent;
  Point<3> viewpoint = Point<3>::Zero();  ///< for Orient::viewpoint
  Progress progress = {};
};

/// What estimate_normals did.
struct NormalReport {
  Index neighbors = 0;       ///< points per normal
  Index duplicates = 0;      ///< points that coincide with an earlier one; they share its normal
  Index undetermined = 0;    ///< zero normals
  OrientReport orientation;  ///< for Orient::consistent
};

/// Unit normals of points on a surface: the eigenvector of the smallest eigenvalue of the covariance of the
/// nearest points (Hoppe et al. 1992), weighted by 1 - d^2/h^2, then tilted by the linear part of a quadric fitted to
/// the same points in that frame (jet, Cazals and Pouget 2005) with a slight ridge on the quadratic terms. The quadric
/// removes the error of curved surfaces under uneven sampling: from 0.5 to 0.02 degrees on a torus of 1e5 random
/// points, from 5.6 to 3.2 on a scanned figure; it is neutral on creases and in noise.
///
/// The automatic number of neighbours minimises the median of (l0 / l1)^(1/2) K^(1/3) over a sample of points, l0 <= l1
/// <= l2 the eigenvalues: l0 / l1 grows with K by curvature but falls while noise makes up the thickness. Where no K
/// shows a smooth surface, it is that of the least thickness before other sheets come in, and the normals, once
/// oriented, are fitted again to neighbours of the same sheet, as many as suit. Beyond 32 neighbours, nearby points
/// share a neighbourhood and its quadric.
///
/// Height fields have one side (orient_height_field()). Other signs come from the winding number (see
/// consistent_normals()), and so does the normal itself where both differ by more than 30 degrees, as on creases and on
/// parts thinner than the neighbourhoods, by a share that grows up to there. Sheets without inside, and less than 50
/// points, are left to orient_normals(), as are clouds of more than 100,000, and sheets from which the winding number
/// would cut hills as solids (cuts_sheet()). Where such normals of neighbours contradict each other, as of a body
/// inside a cavity that was turned in part, signs by orient_normals() count instead if they enclose a solid clearly
/// better (winding_sides()). On plates thinner than the distance between points both sheets look like one rough one:
/// where the winding number takes them for that, though the points lie on two parallel quadrics, these give the
/// normals, for plates, not for gaps; and not where the winding number beyond both sheets shows a solid seen twice, by
/// scans that do not fit, rather than plates.
///
/// Coinciding points count once. Where the neighbours lie on a line, their number is doubled until they do not, up to
/// 256; a normal that remains undetermined is zero. Invariant under similarities, up to signs for Orient::none. Throws
/// InvalidInput for coordinates that are not finite, fewer than 3 distinct points, or points on one line. O(n log n):
/// 0.5 s for 1e5 points on one core, more under noise. `report` receives the details if given.
Points<3> estimate_normals(const PointsRef<3>& points, const NormalOptions& options = {},
                           NormalReport* report = nullptr);

/// The same for different points in Morton order, not all on one line, of which there is a tree already.
Points<3> estimate_normals(const Points<3>& points, const KdTree<3>& tree, Orient orient, const Progress& progress);

}  // namespace csrbf
