#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

namespace csrbf {

struct NeighborTable;

/// Options of orient_normals.
struct OrientOptions {
  /// Neighbours per point in the graph of points whose normals should agree; 12 was chosen by hand. More: slower, and
  /// edges across thin sheets; fewer: more components.
  Index neighbors = 12;
  /// The normals have signs that are mostly right: neighbours that contradict each other are not trusted, so that the
  /// tree follows the given signs first.
  bool signs_given = false;
  Progress progress = {};
};

/// What determined the signs.
enum class OrientMethod {
  spanning_tree,  ///< neighbours alone
  winding_number  ///< parts were flipped so that the surface encloses a solid
};

struct OrientReport {
  OrientMethod method = OrientMethod::spanning_tree;
  double flipped_edges = 0;  ///< share of the edges of the spanning tree whose normals disagreed
  double turned = 0;         ///< share of the normals that were flipped
  /// How far the cloud is from a closed oriented surface by its winding number: 0 is perfect, a few hundredths usual, 1
  /// as bad as random signs. After the spanning tree, and in the end.
  double ambiguity_tree = 0, ambiguity = 0;
};

/// Gives normals of unknown sign a consistent one, outward where the surface encloses a solid. Axes and lengths of the
/// normals do not change; zero normals stay zero.
///
/// Spanning tree (Hoppe et al. 1992): neighbours connected by the edges of least 1 - |n_i . n_j| agree. The cost of an
/// edge also includes its angle with the two tangent planes and the roughness around its ends, so that the tree does
/// not cross thin sheets, and reaches creases, blades and noise last. Where the neighbour graph is disconnected, edges
/// between ever sparser subsets join its components.
///
/// One wrong edge of the tree flips everything behind it. The tree is therefore cut at doubtful edges into at most 400
/// clusters, whose signs are chosen by the winding number w of the whole (as in the dipole propagation of Metzer et al.
/// 2021 and in parametric Gauss reconstruction, Lin et al. 2022, but with an energy whose minimum is known): w must be
/// 0 or 1 off the surface and 1/2 on it. Greedy flips of clusters and of branches of the tree lower that energy. The
/// signs of components are always chosen this way; those of clusters only if the energy falls by more than 3 %, because
/// noise always allows a small decrease, the surface then encloses a solid, well or without cutting sheets by seams:
/// hills and houses of an open sheet are nearly solids one by one, but would be cut from it. Where nothing encloses a
/// solid, as a statue with the ground that it stands on, clusters are turned so that w changes little along the
/// surface, for w takes two values beside a surface with one side, and three where the ground is turned; then
/// components that enclose a solid by themselves are turned outward, and the others together upward. A closed shell
/// inside another bounds a cavity, so its normals point into the cavity. The normals of an open sheet without inside
/// point to the side of +z (else +y, +x).
///
/// Throws InvalidInput if sizes differ or a value is not finite. O(n log n): 0.3 s for 1e5 points on one core.
OrientReport orient_normals(const PointsRef<3>& points, Points<3>& normals, const OrientOptions& options = {});

/// The same for points in Morton order whose neighbours are known; coordinates of moderate size.
OrientReport orient_normals(const Points<3>& points, const NeighborTable& neighbors, Points<3>& normals,
                            const Progress& progress = {}, bool signs_given = false);

/// Share of the pairs of neighbours whose normals point to the same side, among reliable pairs that lie along the
/// surface: 1 for consistent normals, 1/2 for random signs. Points without normal (zero) do not count; 1 if there are
/// no pairs. Throws as orient_normals.
double orientation_consistency(const PointsRef<3>& points, const PointsRef<3>& normals);

}  // namespace csrbf
