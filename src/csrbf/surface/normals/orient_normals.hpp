#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

namespace csrbf {

struct NeighborTable;

/// Options of orient_normals().
struct OrientOptions {
  /// Neighbours per point in the graph of points whose normals should agree. More: slower, and edges across thin
  /// sheets; fewer: more components.
  Index neighbors = 12;
  /// Whether the signs given are mostly right. Neighbours that contradict each other are then not trusted, so that the
  /// tree follows the given signs first.
  bool signs_given = false;
  Progress progress = {};
};

/// What determined the signs.
enum class OrientMethod {
  spanning_tree,  ///< agreement of neighbours alone
  winding_number  ///< parts were flipped so that the surface encloses a solid
};

struct OrientReport {
  OrientMethod method = OrientMethod::spanning_tree;
  double flipped_edges = 0;  ///< share of the edges of the spanning tree whose normals disagreed
  double turned = 0;         ///< share of the normals that were flipped
  /// How far the points are from a closed oriented surface, by their winding number: 0 is perfect, a few hundredths are
  /// usual, 1 is as bad as random signs. After the spanning tree, and at the end.
  double ambiguity_tree = 0, ambiguity = 0;
};

/// Gives normals of unknown sign consistent signs, outward if the surface encloses a solid. Nothing but signs changes;
/// zero normals stay zero.
///
/// Spanning tree (Hoppe et al. 1992): neighbours agree along the edges of least 1 - |n_i . n_j|. The cost of an edge
/// also includes its angles with the two tangent planes and the roughness at its ends. So the tree does not cross thin
/// sheets and reaches creases, blades and noise last. Components of the neighbour graph are joined by edges between
/// ever sparser subsets.
///
/// Winding number: one wrong edge of the tree flips everything behind it. So the tree is cut at doubtful edges into at
/// most 400 clusters, whose signs are chosen by the winding number w of the whole surface: it must be 0 or 1 off the
/// surface and 1/2 on it. (Metzer et al. 2021 and Lin et al. 2022 do so with other energies; the minimum of this one is
/// known.) Flipping clusters and branches of the tree greedily lowers the energy. The signs of components are always
/// chosen in this way. Those of clusters are only if the energy falls by more than 3 %, because noise always allows a
/// small decrease, and if the surface then encloses a solid without seams that cut sheets: hills and houses on an open
/// sheet are nearly solids, but would be cut from it.
///
/// If nothing encloses a solid, as with a statue and the ground that it stands on, clusters are flipped so that w
/// changes little along the surface: w takes two values beside a surface with one side, and three where the ground is
/// flipped. Then components that enclose a solid on their own are turned outward, and the others together upward.
///
/// A closed shell inside another one bounds a cavity, and its normals point into the cavity. The normals of an open
/// sheet without inside point towards +z (else +y, +x).
///
/// Throws InvalidInput if sizes differ or a value is not finite; Cancelled. O(n log n): 0.3 s for 1e5 points on one
/// core.
OrientReport orient_normals(const PointsRef<3>& points, Points<3>& normals, const OrientOptions& options = {});

/// The same for points in Morton order, with coordinates of moderate size, whose neighbours are known.
OrientReport orient_normals(const Points<3>& points, const NeighborTable& neighbors, Points<3>& normals,
                            const Progress& progress = {}, bool signs_given = false);

/// Share of the pairs of neighbours whose normals point to the same side: 1 for consistent normals, 1/2 for random
/// signs, 1 if there are no pairs. Only reliable pairs that lie along the surface count, and no zero normals. Throws as
/// orient_normals().
double orientation_consistency(const PointsRef<3>& points, const PointsRef<3>& normals);

}  // namespace csrbf
