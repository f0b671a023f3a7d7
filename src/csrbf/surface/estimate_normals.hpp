#pragma once

#include "csrbf/surface/normals/orient_normals.hpp"

namespace csrbf {

template <int Dim>
class KdTree;

/// Orientation of estimated normals.
enum class Orient {
  consistent,  ///< neighbours agree; outward if there is an outside, see orient_normals()
  viewpoint,   ///< towards one point, such as the scanner
  none         ///< arbitrary
};

struct NormalOptions {
  /// Number of points, itself included, from which each normal is estimated; at least 3. 0: one number for the cloud,
  /// chosen from it: 16 for clean points, up to 512 in noise, fewer where that would reach another sheet.
  Index neighbors = 0;
  Orient orient = Orient::consistent;
  Point<3> viewpoint = Point<3>::Zero();  ///< for Orient::viewpoint
  Progress progress = {};
};

/// What estimate_normals() did.
struct NormalReport {
  Index neighbors = 0;       ///< points per normal
  Index duplicates = 0;      ///< points at the place of an earlier one; they share its normal
  Index undetermined = 0;    ///< normals that are zero
  OrientReport orientation;  ///< for Orient::consistent
};

/// Estimates the unit normals of points on a surface (3 x n). Each is the eigenvector of the smallest eigenvalue of the
/// covariance of the nearest points (Hoppe et al. 1992), weighted by 1 - d^2/h^2. It is then tilted by the linear part
/// of a quadric fitted to the same points (jet, Cazals and Pouget 2005) with a slight ridge on the quadratic terms. The
/// quadric removes the error on curved, unevenly sampled surfaces: 0.5 becomes 0.02 degrees on a torus of 1e5 random
/// points, 5.6 becomes 3.2 on a scanned figure. On creases and in noise it makes no difference.
///
/// The automatic number of neighbours K minimises the median of (l0 / l1)^(1/2) K^(1/3) over a sample of points, with
/// eigenvalues l0 <= l1 <= l2: l0 / l1 grows with K by curvature, but falls as long as noise makes up the thickness. If
/// no K shows a smooth surface, it is the one of least thickness before other sheets come in, and once oriented the
/// normals are fitted again to neighbours on the same sheet. Beyond 32 neighbours, nearby points share a neighbourhood
/// and its quadric.
///
/// Signs: the normals of a height field all point to one side. For other clouds of 50 to 100,000 points the winding
/// number decides. It also replaces a share of the normal itself where both differ, as on creases and on parts thinner
/// than a neighbourhood; the share grows up to 30 degrees, where it is all of it. orient_normals() decides for fewer or
/// more points, for sheets without inside, and for sheets from which the winding number would cut hills as solids; also
/// where neighbours contradict each other, as on a body inside a cavity that was flipped in part, if its signs enclose
/// a solid clearly better. On plates thinner than the distance between points both sheets look like one rough sheet; if
/// the points lie on two parallel quadrics, these give the normals, but not in gaps, nor where scans of one solid do
/// not fit.
///
/// Coinciding points count once. If the neighbours lie on a line, their number is doubled until they do not, up to 256;
/// a normal that is still undetermined is zero. Results rotate, move and scale with the points, up to signs with
/// Orient::none. `report`, if given, receives the details. O(n log n): 0.5 s for 1e5 points on one core, more in noise.
/// Throws InvalidInput for coordinates that are not finite, fewer than 3 distinct points, and points on a line;
/// Cancelled.
Points<3> estimate_normals(const PointsRef<3>& points, const NormalOptions& options = {},
                           NormalReport* report = nullptr);

/// The same for distinct points in Morton order, not all on a line, whose tree exists already.
Points<3> estimate_normals(const Points<3>& points, const KdTree<3>& tree, Orient orient, const Progress& progress);

}  // namespace csrbf
