#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/core/progress.hpp"

#include <optional>
#include <span>
#include <vector>

namespace csrbf {

struct ObjectOptions {
  bool split = true;  ///< whether to split touching objects; false: each connected component (by faces) is one object
  /// Objects with fewer voxels are left out, and smaller holes filled; at least 1. Unset: objects smaller than a tenth
  /// of the median are left out as specks, and no holes are filled.
  std::optional<Index> min_size = {};
  Progress progress = {};
};

/// Size and shape of an object, in the unit of the spacing.
struct ObjectMeasure {
  int label = 0;
  Index voxels = 0;
  double volume = 0;             ///< of its voxels; 2D: area
  double area = 0;               ///< of its boundary, from how often lines cross it (Crofton); 2D: length
  Point<3> centroid = {};        ///< in physical coordinates
  std::array<double, 3> axes{};  ///< full lengths of the axes of the ellipsoid with the same second moments, longest
                                 ///< first; 2D: the last is 0
  double mean = 0;               ///< mean intensity; for several components, the mean of all
  double sphericity = 0;         ///< area (2D: length) of the ball of equal volume over `area`: at most 1, for a ball
};

struct Objects {
  std::vector<std::int32_t> labels;  ///< 1 to n, in the order of their first voxels; 0: outside
  std::vector<ObjectMeasure> table;  ///< one for each label
  Index left_out = 0;                ///< number of objects that were too small
};

/// The objects that the labels other than 0 mark, with touching ones split. Basins of the distance to the outside are
/// merged as long as that shortens the description of their shapes: one ellipsoid or bent rod instead of two, and the
/// voxels where it is wrong. Valleys of the image (for several components, of their mean) become borders between
/// objects where that shortens the description too. O(n log n). Throws InvalidInput if the number of labels is not that
/// of the voxels, for more than one frame, and for min_size < 1; Cancelled.
Objects find_objects(const Volume<float>& image, std::span<const std::uint8_t> labels,
                     const ObjectOptions& options = {});

}  // namespace csrbf
