#pragma once

#include "csrbf/core/types.hpp"
#include "csrbf/surface/composite/composite.hpp"
#include "csrbf/surface/composite/patches.hpp"

#include <vector>

namespace csrbf {

/// A place on the rim of a patch that no other patch covers well.
struct CoverageGap {
  Point<3> middle, normal;
  Point<3> onward;  ///< direction in which samples must go on: else the cloud ends there
  double reach;     ///< how far the samples around it are looked for
};

/// Probes the patches at eight places on the rim of each, where others must cover the surface: those where they hardly
/// do. O(patches).
std::vector<CoverageGap> find_coverage_gaps(const Patches& patches);

/// The samples around a gap on its sheet, for a patch over it; none where the cloud ends.
void samples_around(const OrientedPoints& cloud, const KdTree<3>& tree, const CoverageGap& gap,
                    std::vector<Index>& ids);

}  // namespace csrbf
