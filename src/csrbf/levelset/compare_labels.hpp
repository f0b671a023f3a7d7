#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/core/progress.hpp"

#include <vector>

namespace csrbf {

struct CompareLabelsOptions {
  /// Whether to treat all labels other than 0 as one.
  bool inside_only = false;

  Progress progress{};  ///< stage "compare"
};

/// How well two images agree, for one label or for all of them. A: its voxels in the image; B: in the reference.
struct LabelAgreement {
  double dice = 1;         ///< 2 |A and B| / (|A| + |B|)
  double jaccard = 1;      ///< |A and B| / |A or B|
  double hausdorff95 = 0;  ///< between the border voxels of A and B, in the unit of the spacing
};

struct LabelComparison : LabelAgreement {
  std::int32_t label = 0;
  Index voxels = 0;            ///< |A|
  Index reference_voxels = 0;  ///< |B|
};

/// Agreement of all labels together: Dice and Jaccard from the sums over the labels, hausdorff95 the largest of any
/// label.
struct LabelsComparison : LabelAgreement {
  std::vector<LabelComparison> labels;  ///< all labels of either image except 0, ascending
};

/// Compares two label images voxel by voxel. Labels are whole numbers, with 0 outside. hausdorff95 is the larger of two
/// 95th percentiles: of the distances from each border voxel of A to the nearest one of B, and vice versa. A border
/// voxel has a neighbour across a face with another label, or lies at the end of an axis (axes of a single voxel do not
/// count). hausdorff95 is infinite for a label that only one image has. Two images without labels agree perfectly.
///
/// Throws InvalidInput if the images have several values per voxel or frames, differ in size, or are more than a
/// hundredth of a voxel apart in space (after conversion between patient spaces), if a value is not a whole number, and
/// for more than 4096 labels. O(voxels), plus O(bounding box) for each label.
LabelsComparison compare_labels(const Volume<float>& labels, const Volume<float>& reference,
                                const CompareLabelsOptions& options = {});

}  // namespace csrbf
