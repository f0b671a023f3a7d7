#pragma once

#include "csrbf/core/field.hpp"

#include <atomic>

namespace csrbf::polygonization {

/// Samples a field minus a level, counts the samples and rejects values that are not finite. Thread safe.
class LevelSampler {
 public:
  LevelSampler(const Field<3>& field, double level) : field_(field), level_(level) {}

  /// Values at any number of points, on all threads. Throws SolverFailure with the position of the first value that is
  /// not finite.
  [[nodiscard]] Eigen::VectorXd values(const PointsRef<3>& points);

  /// Values and gradients at any number of points, on all threads. Gradients are not checked.
  [[nodiscard]] Jet<3> jet(const PointsRef<3>& points);

  /// Fills a block of values, and gradients unless null, on the calling thread.
  void sample_block(const PointsRef<3>& points, double* value, double* gradient);

  [[nodiscard]] Index value_count() const { return value_count_; }
  [[nodiscard]] Index gradient_count() const { return gradient_count_; }

 private:
  void subtract_level(const PointsRef<3>& points, double* value) const;

  const Field<3>& field_;
  double level_;
  std::atomic<Index> value_count_{0};
  std::atomic<Index> gradient_count_{0};
};

}  // namespace csrbf::polygonization
