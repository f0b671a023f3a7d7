#include "csrbf/approx/transform/fit_transformed.hpp"

#include "csrbf/approx/transform/choose_transform.hpp"
#include "csrbf/approx/transform/transformed_back.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

// Errors and weights are those of the values, and so are what other options say of them: these stay as they are.
bool may_transform(const FitOptions& options) {
  return options.transform == "auto" && options.method == "auto" && options.kernel == "auto" && !options.smoothing &&
         !options.degree && options.tolerance == 0 && options.centers == 0 && options.loss == "auto" &&
         options.extrapolation == Extrapolation::automatic && options.drift.empty() && options.gradients.size() == 0;
}

template <int Dim>
std::vector<Transform> transforms_of(const Samples<Dim>& samples, const FitOptions& options) {
  std::vector<Transform> result(static_cast<std::size_t>(samples.components()), Transform::none);
  if (options.transform == "none") return result;
  if (options.transform != "auto") {
    std::fill(result.begin(), result.end(), options.transform == "log" ? Transform::logarithm : Transform::square_root);
    return result;
  }
  // Chosen by hand. Each column takes time; more samples hardly need to know how their values are distributed.
  constexpr Index most_columns = 8, most_samples = 20'000;
  if (!may_transform(options) || samples.weights.size() > 0 || samples.components() > most_columns ||
      samples.size() > most_samples)
    return result;
  for (Index c = 0; c < samples.components(); ++c) {
    std::vector<Index> present;
    bool is_negative = false;
    for (Index i = 0; i < samples.size(); ++i) {
      if (samples.values(i, c) == options.missing) continue;
      present.push_back(i);
      is_negative = is_negative || samples.values(i, c) < 0;
    }
    if (is_negative) continue;
    const Samples<Dim> one{samples.points(Eigen::all, present), samples.values(present, c), {}};
    result[static_cast<std::size_t>(c)] = choose_transform(SampleView(one), morton_order<Dim>(one.points));
  }
  return result;
}

void require_transformable(Transform transform, double value, Index sample) {
  require(std::isfinite(transformed(transform, value)), "fit", "transform", name_of(transform),
          "sample " + std::to_string(sample) + " (from 0) has the value " + std::to_string(value) + "; all must be " +
              (transform == Transform::logarithm ? "positive" : "0 or positive"));
}

// Root mean squares over places where z is known.
struct Typical {
  double noise = 0, slope = 0;
};

Typical typical_of(Transform transform, const Eigen::VectorXd& z, double noise) {
  Typical sums;
  for (const double at : z) {
    sums.noise += std::pow(noise_of_value(transform, at, noise), 2);
    sums.slope += std::pow(mean_value(transform, at, noise).slope, 2);
  }
  const auto n = static_cast<double>(z.size());
  return {std::sqrt(sums.noise / n), std::sqrt(sums.slope / n)};
}

}  // namespace

std::vector<std::string> fit_transforms() {
  return {"auto", "none", "sqrt", "log"};
}

void check_transform(const FitOptions& options) {
  const std::vector<std::string> names = fit_transforms();
  require(std::find(names.begin(), names.end(), options.transform) != names.end(), "fit", "transform",
          options.transform, "unknown; use one of " + joined(names));
  if (options.transform == "auto" || options.transform == "none") return;
  const auto without = [&](bool is_given, const char* what) {
    require(!is_given, "fit", "transform", options.transform, std::string("does not go with ") + what);
  };
  without(options.tolerance > 0, "a tolerance, which is one of the values");
  without(!options.drift.empty(), "a drift, which adds to the values");
  without(options.gradients.size() > 0, "derivatives, which are those of the values");
}

template <int Dim>
std::optional<Fit<Dim>> fit_transformed(const Samples<Dim>& samples, const FitOptions& options,
                                        const std::function<Fit<Dim>(const Samples<Dim>&, const FitOptions&)>& fit) {
  using Back = TransformedBack<Dim>;
  const std::vector<Transform> transforms = transforms_of(samples, options);
  const auto is_none = [](Transform transform) { return transform == Transform::none; };
  if (std::all_of(transforms.begin(), transforms.end(), is_none)) return std::nullopt;
  Samples<Dim> there = samples;
  for (Index c = 0; c < samples.components(); ++c)
    for (Index i = 0; i < samples.size(); ++i) {
      double& value = there.values(i, c);
      if (options.missing == value) continue;
      const Transform transform = transforms[static_cast<std::size_t>(c)];
      require_transformable(transform, value, i);
      value = transformed(transform, value);
    }
  FitOptions given = options;
  given.transform = "none";
  // What a trend is far outside would be one of roots or logarithms.
  if (options.extrapolation == Extrapolation::automatic) given.extrapolation = Extrapolation::constant;
  Fit<Dim> result = fit(there, given);
  FitReport& report = result.report;
  const bool knows_noise = std::ssize(report.noise) == samples.components();
  double squared_slopes = 0;
  for (std::size_t c = 0; c < transforms.size(); ++c) {
    typename Back::Parts parts{transforms[c], Back::Of::value, knows_noise ? report.noise[c] : 0, result.components[c]};
    const Typical typical =
        typical_of(transforms[c], result.components[c]->evaluate(samples.points).value, parts.noise);
    result.components[c] = std::make_shared<const Back>(parts);
    if (!result.variances.empty()) {
      parts.variance = result.variances[c];
      parts.of = Back::Of::sample;
      result.variances[c] = std::make_shared<const Back>(parts);
      parts.of = Back::Of::function;
      if (knows_noise) result.function_variances.push_back(std::make_shared<const Back>(parts));
    }
    if (knows_noise) report.noise[c] = typical.noise;
    squared_slopes += typical.slope * typical.slope / static_cast<double>(transforms.size());
    report.transforms.push_back(name_of(transforms[c]));
  }
  report.cross_validation_rmse *= std::sqrt(squared_slopes);
  return result;
}

#define CSRBF_INSTANTIATE(Dim)                           \
  template std::optional<Fit<Dim>> fit_transformed<Dim>( \
      const Samples<Dim>&, const FitOptions&, const std::function<Fit<Dim>(const Samples<Dim>&, const FitOptions&)>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
