#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/core/progress.hpp"

#include <optional>
#include <span>
#include <vector>

namespace csrbf {

struct ObjectOptions {
  bool split = true;  ///< touching objects; false: the connected parts (by faces) are the objects
  /// Voxels: smaller objects are left out, smaller holes filled. Unset: objects smaller than a tenth of the median of
  /// all are specks, and left out; no holes are filled.
  std::optional<Index> min_size = {};
  Progress progress = {};
};

/// Size and shape of an object. Lengths are in the unit of the spacing, in the plane of voxels 1 x 1 without one.
struct ObjectMeasure {
  int label = 0;
  Index voxels = 0;
  double volume = 0;             ///< of the voxels; 2D: area
  double area = 0;               ///< of its boundary, by how often lines meet it (Crofton); 2D: length
  Point<3> centroid = {};        ///< physical
  std::array<double, 3> axes{};  ///< of the ellipsoid with the same second moments, the longest first; 2D: 0 last
  double mean = 0;               ///< of the intensities
  double sphericity = 0;         ///< area (length) of the ball of that volume over `area`: at most 1, for a ball
};

struct Objects {
  std::vector<std::int32_t> labels;  ///< 1 to n in the order of the first voxels; 0 outside
  std::vector<ObjectMeasure> table;  ///< one for each label
  Index left_out = 0;                ///< number of objects that are too small
};

/// The objects that labels other than 0 mark. Touching ones are split: basins of the distance to the outside are joined
/// as long as that makes the description of their shapes shorter: an ellipsoid each, or one or a rod bent along an arc,
/// and the voxels that it misplaces. Valleys of the image (of several components: of their mean) are borders where that
/// makes it shorter, too, and most of them become some. O(n log n). Throws InvalidInput for arrays of other sizes than
/// the image and min_size < 1; Cancelled.
Objects find_objects(const Volume<float>& image, std::span<const std::uint8_t> labels,
                     const ObjectOptions& options = {});

}  // namespace csrbf
