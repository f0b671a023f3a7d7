#pragma once

#include "csrbf/levelset/regions/intensity_histogram.hpp"

#include <vector>

namespace csrbf {

/// Classes of intensities, those of the lowest first.
struct IntensityClasses {
  std::vector<double> means;       ///< of the classes, increasing
  std::vector<double> thresholds;  ///< between neighbouring classes, halfway between their means
  double energy = 0;               ///< sum of count (x - mean of its class)^2 over the bin centres x
};

/// The partition of the histogram into `classes` intervals of least energy: k-means in one dimension, solved exactly
/// by dynamic programming. For two classes this is the threshold of Otsu, and the exact minimum of the functional of
/// Chan and Vese without length. O(bins) for 2 classes, O(classes bins^2) for more. Throws InvalidInput unless 1 <=
/// classes <= number of bins that are not empty.
IntensityClasses optimal_classes(const Histogram& histogram, Index classes);

}  // namespace csrbf
