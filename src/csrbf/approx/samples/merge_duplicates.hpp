#pragma once

#include "csrbf/approx/samples/samples.hpp"

#include <vector>

namespace csrbf {

/// What samples at the same points say about the noise of values: nothing if each has the same values as the others at
/// its point, within 1e-6 of their range, for these are copies.
struct Replicates {
  Eigen::VectorXd squares = {};  ///< by component: weighted sum of the squared differences to the means of the points
  Index count = 0;               ///< samples minus distinct points, without those of weight 0
};

template <int Dim>
struct MergedSamples {
  Samples<Dim> samples;      ///< one per distinct point, in the order of first appearance
  Eigen::VectorXd spread;    ///< half the largest difference of values at the point; 0 without duplicates
  std::vector<Index> place;  ///< for each input sample the merged one that contains it
  Replicates replicates = {};

  [[nodiscard]] Index merged() const { return static_cast<Index>(place.size()) - samples.size(); }
};

/// The value that represents several at one point: their weighted mean, or the midpoint of their range, which has the
/// smallest maximum error.
enum class DuplicateValue { mean, midrange };

/// Replaces samples at the same point by one with their weighted mean (the plain mean where all weights are 0) or
/// midrange and the sum of their weights: interpolation with a repeated point is singular, and with the mean the
/// objective of least squares changes only by a constant. If all are copies, it has the largest of the weights. Without
/// duplicates the samples, and empty weights, do not change. O(N).
template <int Dim>
MergedSamples<Dim> merge_duplicates(Samples<Dim> samples, DuplicateValue value = DuplicateValue::mean);

}  // namespace csrbf
