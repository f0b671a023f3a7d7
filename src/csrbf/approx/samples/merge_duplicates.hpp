#pragma once

#include "csrbf/approx/samples/samples.hpp"

#include <vector>

namespace csrbf {

template <int Dim>
struct MergedSamples {
  Samples<Dim> samples;      ///< one per distinct point, in the order of first appearance
  Eigen::VectorXd spread;    ///< half the largest difference of values at the point; 0 without duplicates
  std::vector<Index> place;  ///< for each input sample the merged one it went into

  [[nodiscard]] Index merged() const { return static_cast<Index>(place.size()) - samples.size(); }
};

/// The value that stands for several at one point: their weighted mean, or the middle of their range, which is nearest
/// to the farthest of them.
enum class DuplicateValue { mean, midrange };

/// Replaces samples at the same point by one with their weighted mean (the plain mean where all weights are 0) or
/// midrange and the sum of their weights: interpolation at a point given twice is singular, and with the mean least
/// squares is unchanged but for a constant. Without duplicates the samples, and empty weights, stay as they are. O(N).
template <int Dim>
MergedSamples<Dim> merge_duplicates(Samples<Dim> samples, DuplicateValue value = DuplicateValue::mean);

}  // namespace csrbf
