#pragma once

#include "csrbf/surface/composite/composite.hpp"
#include "csrbf/surface/composite/patches.hpp"

namespace csrbf {

/// A point on the rim of a patch that no other patch covers well.
struct CoverageGap {
  Point<3> middle, normal;
  Point<3> onward;  ///< away from the patch: without samples in this direction the cloud ends here
  double reach;     ///< search radius for the samples around it
};

/// Probes eight points on the rim of each patch, where other patches must cover the surface, and returns those that
/// are hardly covered. O(patches).
std::vector<CoverageGap> find_coverage_gaps(const Patches& patches);

/// The samples around a gap, on its sheet, for a patch over it; none where the cloud ends.
void samples_around(const OrientedPoints& cloud, const KdTree<3>& tree, const CoverageGap& gap,
                    std::vector<Index>& ids);

}  // namespace csrbf
