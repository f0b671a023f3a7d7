#pragma once

#include "csrbf/core/types.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// Nearest neighbours among points whose dimension is known only at run time: by a KdTree in the dimensions it
/// supports, by exhaustive search beyond. The memory of the points must outlive it.
class NearestSamples {
 public:
  NearestSamples() = default;
  NearestSamples(const NearestSamples&) = delete;
  NearestSamples& operator=(const NearestSamples&) = delete;
  virtual ~NearestSamples() = default;

  /// Writes the k nearest of the n >= k points to `indices`; `squared_distances` is work space for k numbers. Thread
  /// safe.
  virtual void nearest(const double* x, Index k, Index* indices, double* squared_distances) const = 0;
};

/// `points`: d x n.
std::unique_ptr<const NearestSamples> nearest_samples(const Eigen::MatrixXd& points);

/// morton_order() of points, or the given order in dimensions that it does not support.
std::vector<Index> nearby_order(const Eigen::Ref<const Eigen::MatrixXd>& points);

}  // namespace csrbf
