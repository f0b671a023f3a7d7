#pragma once

#include "csrbf/levelset/segment.hpp"

#include <vector>

namespace csrbf {

/// Size of one region of a segmentation.
struct RegionMeasure {
  int label = 0;
  Index voxels = 0;
  double volume = 0;  ///< of the level set, not of the voxels; 2D: area. In the unit of the spacing, cubed (squared)
  double area = 0;    ///< of its boundary inside the image; 2D: length
  double mean = 0;    ///< of the intensities of its voxels
};

/// Measures all regions but 0 by their contours within the image, with errors of fourth order in the spacing of the
/// centers (image_contour()). Ignores masks: a level set continues behind them.
template <int Dim>
std::vector<RegionMeasure> measure_segmentation(const Segmentation<Dim>& segmentation, const Grid& grid);

}  // namespace csrbf
