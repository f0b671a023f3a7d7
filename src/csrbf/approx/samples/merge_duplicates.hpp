#pragma once

#include "csrbf/approx/samples/samples.hpp"

#include <vector>

namespace csrbf {

/// What samples at the same points say about the noise of values.
struct Replicates {
  Eigen::VectorXd squares = {};  ///< by component: weighted sum of the squared differences to the means of the points
  Index count = 0;               ///< samples minus distinct points, without copies and those of weight 0
};

template <int Dim>
struct MergedSamples {
  Samples<Dim> samples;      ///< one per distinct point, in the order of first appearance
  Eigen::VectorXd spread;    ///< half the largest difference of values at the point; 0 without duplicates
  std::vector<Index> place;  ///< for each input sample the merged one that contains it
  Replicates replicates = {};

  [[nodiscard]] Index merged() const { return static_cast<Index>(place.size()) - samples.size(); }
};

/// Sets the weights of copies to 0, but for one with the largest of theirs: samples at one place with the same values,
/// within 1e-6 of the range, that are more than noise of whole or rounded numbers makes equal. All are copies if no
/// values differ at any place. `place`: a number for each sample, the same for all at one place. O(N log N).
template <int Dim>
void count_copies_once(Samples<Dim>& samples, const std::vector<Index>& place);

/// The value that represents several at one point: their weighted mean, or the midpoint of their range, which has the
/// smallest maximum error.
enum class DuplicateValue { mean, midrange };

/// Replaces samples at the same point by one with their weighted mean (the plain mean where all weights are 0) or
/// midrange and the sum of their weights: interpolation with a repeated point is singular, and with the mean the
/// objective of least squares changes only by a constant. Copies count once. Without duplicates the samples, and empty
/// weights, do not change. O(N), with duplicates O(N log N).
template <int Dim>
MergedSamples<Dim> merge_duplicates(Samples<Dim> samples, DuplicateValue value = DuplicateValue::mean);

}  // namespace csrbf
