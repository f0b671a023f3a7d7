#include "csrbf/approx/fit_by_covariances.hpp"

#include "csrbf/approx/kriging/left_out_planes.hpp"
#include "csrbf/approx/samples/average_field.hpp"
#include "csrbf/approx/samples/mapped_field.hpp"
#include "csrbf/core/error.hpp"

#include <cmath>
#include <numeric>
#include <utility>

namespace csrbf {

template <int Dim>
LearnedCovariance learned_covariance(const Samples<Dim>& samples, const Replicates& replicates,
                                     const AxisCovariance<Dim>& covariance) {
  return {covariance.kernel,
          covariance.lengths.minCoeff(),
          covariance.nugget,
          covariance.degree,
          variance_by_planes(without_zero_weights(samples), covariance),
          replicates};
}

template <int Dim>
MethodFields<Dim> fit_by_covariances(const Samples<Dim>& samples, const Replicates& replicates,
                                     const FitOptions& options, const std::vector<AxisCovariance<Dim>>& likely,
                                     FitReport& report) {
  using Fields = std::vector<std::shared_ptr<const Field<Dim>>>;
  const auto C = static_cast<std::size_t>(samples.components());
  std::vector<Fields> components(C), variances(C);
  std::vector<double> weights, noise(C, 0.0);
  const FitReport before = report;
  MethodFields<Dim> result;
  for (const AxisCovariance<Dim>& covariance : likely) {
    typename MappedField<Dim>::Map map =
        (covariance.lengths.minCoeff() / covariance.lengths.array()).matrix().asDiagonal();
    if (covariance.axes) map *= covariance.axes->transpose();
    Samples<Dim> mapped = samples;
    mapped.points = map * samples.points;
    const LearnedCovariance learned = learned_covariance(samples, replicates, covariance);
    FitReport one = before;
    MethodFields<Dim> fields;
    try {
      fields = fit_by_method(mapped, options, FitMethod::interpolate, &learned, one);
    } catch (const SolverFailure&) {
      if (weights.empty() && &covariance == &likely.back()) throw;
      continue;
    }
    for (std::size_t c = 0; c < C; ++c) {
      components[c].push_back(std::make_shared<const MappedField<Dim>>(fields.components[c], map));
      if (c < fields.variances.size())
        variances[c].push_back(std::make_shared<const MappedField<Dim>>(fields.variances[c], map));
      if (c < fields.noise.size()) noise[c] += covariance.weight * fields.noise[c] * fields.noise[c];
    }
    weights.push_back(covariance.weight);
    if (weights.size() == 1) report = std::move(one);
    result.method = fields.method;
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  for (std::size_t c = 0; c < C; ++c) {
    result.components.push_back(std::make_shared<const AverageField<Dim>>(components[c], weights));
    if (variances[c].size() == components[c].size()) {
      result.variances.push_back(std::make_shared<const AverageField<Dim>>(components[c], weights, variances[c]));
      result.noise.push_back(std::sqrt(noise[c] / sum));
    }
  }
  return result;
}

#define CSRBF_INSTANTIATE(Dim)                                                                                  \
  template LearnedCovariance learned_covariance<Dim>(const Samples<Dim>&, const Replicates&,                    \
                                                     const AxisCovariance<Dim>&);                               \
  template MethodFields<Dim> fit_by_covariances<Dim>(const Samples<Dim>&, const Replicates&, const FitOptions&, \
                                                     const std::vector<AxisCovariance<Dim>>&, FitReport&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
