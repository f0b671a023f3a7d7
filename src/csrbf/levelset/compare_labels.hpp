#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/core/progress.hpp"

#include <vector>

namespace csrbf {

struct CompareLabelsOptions {
  /// All labels but 0 are one and the same: what is inside.
  bool inside_only = false;

  Progress progress{};  ///< stage "compare"
};

/// How the voxels of one label, or of all, agree: A in the image, B in the reference.
struct LabelAgreement {
  double dice = 1;         ///< 2 |A and B| / (|A| + |B|)
  double jaccard = 1;      ///< |A and B| / |A or B|
  double hausdorff95 = 0;  ///< between the border voxels of A and B, in units of the spacing
};

struct LabelComparison : LabelAgreement {
  std::int32_t label = 0;
  Index voxels = 0;            ///< |A|
  Index reference_voxels = 0;  ///< |B|
};

/// Of all labels together: Dice and Jaccard from the sums of their voxels, the largest hausdorff95.
struct LabelsComparison : LabelAgreement {
  std::vector<LabelComparison> labels;  ///< those of both images but 0, ascending
};

/// Compares two label images, whole numbers with 0 outside, voxel by voxel. hausdorff95 is the larger of two 95th
/// percentiles: of the distances from each border voxel of A to the nearest one of B, and the other way round. Border
/// voxels have a neighbour across a face that is not of the label, or lie at the end of an axis; axes of one voxel do
/// not count. It is infinite for a label that only one of the images holds. Two images without any label agree.
///
/// Throws InvalidInput when the images have more than one value per voxel or frame, differ in size, or lie apart in
/// space (by more than a hundredth of a voxel, after conversion between the spaces of patients), when a value is not a
/// whole number, and when there are more than 4096 labels. O(voxels) and O(box of the label) for each of them.
LabelsComparison compare_labels(const Volume<float>& labels, const Volume<float>& reference,
                                const CompareLabelsOptions& options = {});

}  // namespace csrbf
