#pragma once

#include "csrbf/core/error.hpp"
#include "csrbf/core/types.hpp"

#include <string>
#include <vector>

namespace csrbf {

/// Scattered data: N points, with k values and a weight each.
template <int Dim>
struct Samples {
  Points<Dim> points;       ///< Dim x N
  Eigen::MatrixXd values;   ///< N x k
  Eigen::VectorXd weights;  ///< N, not negative: inverse variances of the values, up to a factor; empty: all 1

  [[nodiscard]] Index size() const { return points.cols(); }
  [[nodiscard]] Index components() const { return values.cols(); }
  [[nodiscard]] double weight(Index i) const { return weights.size() == 0 ? 1 : weights[i]; }
  [[nodiscard]] Eigen::VectorXd all_weights() const {
    return weights.size() == 0 ? Eigen::VectorXd::Ones(size()).eval() : weights;
  }
};

/// A view of samples whose dimension is known at run time only, for code that is the same in every dimension.
struct SampleView {
  Eigen::Map<const Eigen::MatrixXd> points;
  const Eigen::MatrixXd& values;
  const Eigen::VectorXd& weights;

  template <int Dim>
  explicit SampleView(const Samples<Dim>& samples)
      : points(samples.points.data(), samples.points.rows(), samples.points.cols()),
        values(samples.values),
        weights(samples.weights) {}

  [[nodiscard]] Index size() const { return points.cols(); }
  [[nodiscard]] Index dimension() const { return points.rows(); }
  [[nodiscard]] Index components() const { return values.cols(); }
  [[nodiscard]] double weight(Index i) const { return weights.size() == 0 ? 1 : weights[i]; }
  [[nodiscard]] Eigen::VectorXd all_weights() const {
    return weights.size() == 0 ? Eigen::VectorXd::Ones(size()).eval() : weights;
  }
};

/// Throws InvalidInput in the name of `function` unless there is a sample, sizes match, all numbers are finite, and
/// weights are not negative with at least one positive.
inline void require_valid(const SampleView& samples, const char* function) {
  require(samples.size() > 0, function, "samples", "none", "at least one sample is needed");
  const bool is_transposed = samples.size() == samples.dimension() && samples.values.rows() > samples.size();
  require(
      samples.values.rows() == samples.size(), function, "values", samples.values.rows(),
      std::string("there must be one row of values per point") +
          (is_transposed ? "; points are columns: transpose the N x " + std::to_string(samples.dimension()) + " matrix"
                         : ""));
  require(samples.components() > 0, function, "values", "0 columns", "at least one value per point is needed");
  require(samples.points.allFinite(), function, "points", "NaN or infinity",
          "every coordinate must be finite; remove the other samples");
  require(samples.values.allFinite(), function, "values", "NaN or infinity",
          "every value must be finite; remove the other samples");
  if (samples.weights.size() == 0) return;
  require(samples.weights.size() == samples.size(), function, "weights", samples.weights.size(),
          "there must be one weight per point, or none at all");
  require(samples.weights.allFinite() && samples.weights.minCoeff() >= 0, function, "weights", "negative or not finite",
          "weights must be finite and not negative");
  require(samples.weights.maxCoeff() > 0, function, "weights", "all zero", "at least one weight must be positive");
}

template <int Dim>
void require_valid(const Samples<Dim>& samples, const char* function) {
  require_valid(SampleView(samples), function);
}

/// Makes samples from matrices whose sizes are known at run time only: points Dim x N, values N x k, weights N or none.
/// Throws InvalidInput for other sizes, and as require_valid().
template <int Dim>
Samples<Dim> make_samples(const Eigen::Ref<const Eigen::MatrixXd>& points,
                          const Eigen::Ref<const Eigen::MatrixXd>& values,
                          const Eigen::Ref<const Eigen::VectorXd>& weights = Eigen::VectorXd()) {
  const std::string columns =
      "must be " + std::to_string(Dim) + ": one column per point; transpose an N x " + std::to_string(Dim) + " matrix";
  require(points.rows() == Dim, "Samples", "rows of points", points.rows(), columns);
  Samples<Dim> samples{points, values, weights};
  require_valid(samples, "Samples");
  return samples;
}

/// The samples with these indices, in this order.
template <int Dim>
Samples<Dim> chosen_samples(const Samples<Dim>& samples, const std::vector<Index>& ids) {
  const Index n = std::ssize(ids), k = samples.components();
  Samples<Dim> chosen{Points<Dim>(Dim, n), Eigen::MatrixXd(n, k), Eigen::VectorXd(samples.weights.size() > 0 ? n : 0)};
  for (Index i = 0; i < n; ++i) {
    const Index id = ids[static_cast<std::size_t>(i)];
    for (int a = 0; a < Dim; ++a) chosen.points(a, i) = samples.points(a, id);
    for (Index c = 0; c < k; ++c) chosen.values(i, c) = samples.values(id, c);
    if (chosen.weights.size() > 0) chosen.weights[i] = samples.weights[id];
  }
  return chosen;
}

/// The samples of positive weight; all samples if there are no weights.
template <int Dim>
Samples<Dim> without_zero_weights(const Samples<Dim>& samples) {
  if (samples.weights.size() == 0) return samples;
  std::vector<Index> positive;
  for (Index i = 0; i < samples.size(); ++i)
    if (samples.weights[i] > 0) positive.push_back(i);
  return chosen_samples(samples, positive);
}

/// The same with weights of mean 1.
template <int Dim>
Samples<Dim> normalize_weights(const Samples<Dim>& samples) {
  Samples<Dim> result = without_zero_weights(samples);
  if (result.weights.size() == 0) return result;
  result.weights /= result.weights.maxCoeff();
  result.weights /= result.weights.mean();
  return result;
}

}  // namespace csrbf
