#include "csrbf/implicit/polygonize/level_sampler.hpp"

#include "csrbf/core/error.hpp"

namespace csrbf::polygonization {

Eigen::VectorXd LevelSampler::values(const PointsRef<3>& points) {
  Jet<3> jet = field_.evaluate(points);
  value_count_ += points.cols();
  subtract_level(points, jet.value.data());
  return std::move(jet.value);
}

Jet<3> LevelSampler::jet(const PointsRef<3>& points) {
  Jet<3> jet = field_.evaluate(points, Derivatives::gradient);
  gradient_count_ += points.cols();
  subtract_level(points, jet.value.data());
  return jet;
}

void LevelSampler::sample_block(const PointsRef<3>& points, double* value, double* gradient) {
  field_.evaluate_block(points, {value, gradient, nullptr});
  (gradient != nullptr ? gradient_count_ : value_count_).fetch_add(points.cols(), std::memory_order_relaxed);
  subtract_level(points, value);
}

void LevelSampler::subtract_level(const PointsRef<3>& points, double* value) const {
  for (Index i = 0; i < points.cols(); ++i) {
    value[i] -= level_;
    if (std::isfinite(value[i])) continue;
    std::ostringstream message;
    message << "polygonize: the field is " << value[i] << " at (" << points(0, i) << ", " << points(1, i) << ", "
            << points(2, i) << "): it must be finite near the surface; fix the field or shrink the bounds";
    throw SolverFailure(message.str());
  }
}

}  // namespace csrbf::polygonization
