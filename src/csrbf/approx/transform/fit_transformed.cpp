#include "csrbf/approx/transform/fit_transformed.hpp"

#include "csrbf/approx/transform/choose_transform.hpp"
#include "csrbf/approx/transform/transformed_back.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

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
  // Chosen by hand. Each column takes time; more samples hardly need to know how their values are distributed, and in
  // more variables some of them tell little of what all do: what they leave is no noise.
  constexpr Index most_columns = 8, most_samples = 20'000;
  if (Dim > 3 || !may_transform(options) || samples.weights.size() > 0 || samples.components() > most_columns ||
      samples.size() > most_samples)
    return result;
  for (Index c = 0; c < samples.components(); ++c) {
    std::vector<Index> present;
    for (Index i = 0; i < samples.size(); ++i)
      if (samples.values(i, c) != options.missing) present.push_back(i);
    const Samples<Dim> one{samples.points(Eigen::all, present), samples.values(present, c), {}};
    result[static_cast<std::size_t>(c)] = choose_transform(SampleView(one), morton_order<Dim>(one.points));
    // Beside others, values have one way of extrapolation with them.
    if (result[static_cast<std::size_t>(c)] == Transform::none)
      return std::vector<Transform>(result.size(), Transform::none);
  }
  return result;
}

// The samples on their scales. What is missing has a mark that no other value has there.
template <int Dim>
Samples<Dim> transformed_samples(const Samples<Dim>& samples, const std::vector<Transform>& transforms,
                                 std::optional<double>& missing) {
  Samples<Dim> there = samples;
  double least = 0;
  for (Index c = 0; c < samples.components(); ++c)
    for (Index i = 0; i < samples.size(); ++i) {
      double& value = there.values(i, c);
      if (value == missing) continue;
      const Transform transform = transforms[static_cast<std::size_t>(c)];
      const double given = value;
      value = transformed(transform, given);
      if (!std::isfinite(value))
        throw InvalidInput((std::ostringstream()
                            << "fit: transform = " << name_of(transform) << ": sample " << i
                            << " (from 0) has the value " << given << "; all must be "
                            << (given < 0 && transform == Transform::square_root ? "0 or " : "") << "positive")
                               .str());
      least = std::min(least, value);
    }
  if (!missing) return there;
  for (Index c = 0; c < samples.components(); ++c)
    for (Index i = 0; i < samples.size(); ++i)
      if (samples.values(i, c) == missing) there.values(i, c) = least - 1;
  missing = least - 1;
  return there;
}

// The variance of z, and that of its noise: no variance of a sample far from all others is larger.
double largest_variance(const Eigen::VectorXd& z, const std::optional<double>& missing, double noise) {
  double sum = 0, squares = 0, count = 0;
  for (const double at : z) {
    if (at == missing) continue;
    sum += at;
    ++count;
  }
  for (const double at : z)
    if (at != missing) squares += std::pow(at - sum / count, 2);
  return squares > 0 ? squares / (count - 1) + noise * noise : std::numeric_limits<double>::infinity();
}

// The noise of values where the noise of z is known at these places: root mean square.
double typical_noise(Transform transform, const Eigen::VectorXd& z, double noise) {
  double squares = 0;
  for (const double at : z) squares += std::pow(noise_of_value(transform, at, noise), 2);
  return std::sqrt(squares / static_cast<double>(z.size()));
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
  FitOptions given = options;
  const Samples<Dim> there = transformed_samples(samples, transforms, given.missing);
  given.transform = "none";
  // What a trend is far outside would be one of roots or logarithms.
  if (options.extrapolation == Extrapolation::automatic) given.extrapolation = Extrapolation::constant;
  Fit<Dim> result = fit(there, given);
  FitReport& report = result.report;
  const bool knows_noise = std::ssize(report.noise) == samples.components();
  double left_out = 0;
  for (std::size_t c = 0; c < transforms.size(); ++c) {
    typename Back::Parts parts{transforms[c], Back::Of::value, knows_noise ? report.noise[c] : 0, result.components[c]};
    const Eigen::VectorXd z = result.components[c]->evaluate(samples.points).value;
    result.components[c] = std::make_shared<const Back>(parts);
    if (!result.variances.empty()) {
      parts.variance = result.variances[c];
      parts.largest = largest_variance(there.values.col(static_cast<Index>(c)), given.missing, parts.noise);
      parts.of = Back::Of::sample;
      result.variances[c] = std::make_shared<const Back>(parts);
      parts.of = Back::Of::function;
      if (knows_noise) result.function_variances.push_back(std::make_shared<const Back>(parts));
    }
    if (knows_noise) report.noise[c] = typical_noise(transforms[c], z, parts.noise);
    left_out += std::pow(typical_noise(transforms[c], z, report.cross_validation_rmse), 2);
    report.transforms.push_back(name_of(transforms[c]));
  }
  report.cross_validation_rmse = std::sqrt(left_out / static_cast<double>(transforms.size()));
  return result;
}

#define CSRBF_INSTANTIATE(Dim)                           \
  template std::optional<Fit<Dim>> fit_transformed<Dim>( \
      const Samples<Dim>&, const FitOptions&, const std::function<Fit<Dim>(const Samples<Dim>&, const FitOptions&)>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
