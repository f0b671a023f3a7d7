#include "csrbf/approx/fit_method.hpp"

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/kernels/kernel.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace csrbf {

const std::vector<FitMethodInfo>& fit_method_table() {
  using enum FitMethod;
  constexpr bool no = false, yes = true;
  // clang-format off
  static const std::vector<FitMethodInfo> table = {
      // method, name, what                                                                         centers tolerance degree smoothing parameter duplicates
      {interpolate, "interpolate", "one system for all samples (thesis 2.1)",                           no,  yes, yes, yes, yes, no},
      {least_squares, "least-squares", "fewer centres than samples (thesis 2.5)",                       yes, no,  no,  yes, no,  no},
      {partition_of_unity, "partition-of-unity", "blended local fits (Babuska and Melenk 1997)",        no,  no,  yes, yes, no,  no},
      {multilevel, "multilevel", "levels of nested centres (Floater and Iske 1996)",                    yes, yes, no,  yes, no,  no},
      {pca_multiresolution, "pca-multiresolution", "levels of clusters (thesis 3.1)",                   yes, yes, no,  yes, no,  yes},
      {fixed_budget, "fixed-budget", "the best use of so many centres (thesis 3.2)",                    yes, no,  no,  yes, no,  no},
      {error_bounded, "error-bounded", "an error that no sample exceeds (thesis 3.3)",                  yes, yes, no,  yes, no,  yes},
      {moving_least_squares, "moving-least-squares", "moving polynomials (Lancaster, Salkauskas 1981)", no,  no,  yes, no,  no,  no},
      {along_tracks, "along-tracks", "the same with weights that follow tracks",                        no,  no,  yes, no,  no,  no},
  };
  // clang-format on
  return table;
}

const FitMethodInfo& info_of(FitMethod method) {
  return fit_method_table()[static_cast<std::size_t>(method)];
}

const FitMethodInfo* find_fit_method(std::string_view name) {
  const std::vector<FitMethodInfo>& all = fit_method_table();
  const auto found = std::find_if(all.begin(), all.end(), [&](const FitMethodInfo& info) { return info.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::vector<std::string> fit_losses() {
  return {"auto", "squares", "huber", "student"};
}

std::string name_of(Extrapolation extrapolation) {
  switch (extrapolation) {
    case Extrapolation::nan:
      return "nan";
    case Extrapolation::linear:
      return "linear";
    case Extrapolation::trend:
      return "trend";
    case Extrapolation::automatic:
      return "auto";
    case Extrapolation::constant:
      break;
  }
  return "constant";
}

Extrapolation extrapolation_of(const std::string& name) {
  for (const Extrapolation one : {Extrapolation::automatic, Extrapolation::constant, Extrapolation::nan,
                                  Extrapolation::linear, Extrapolation::trend})
    if (name == name_of(one)) return one;
  throw InvalidInput("extrapolation = " + name + ": unknown; use one of auto, constant, linear, trend, nan");
}

std::vector<std::string> fit_methods() {
  std::vector<std::string> names = {"auto"};
  for (const FitMethodInfo& info : fit_method_table()) names.emplace_back(info.name);
  return names;
}

void check_options(const FitOptions& options, int dimension) {
  require(options.method == "auto" || find_fit_method(options.method) != nullptr, "fit", "method", options.method,
          "unknown; " + did_you_mean(options.method, fit_methods()) + "use one of " + joined(fit_methods()));
  require(options.centers >= 0, "fit", "centers", options.centers, "must be positive, or 0 to let the method decide");
  require(options.tolerance >= 0 && std::isfinite(options.tolerance), "fit", "tolerance", options.tolerance,
          "must be a positive error in the unit of the values, or 0 for none");
  require(!options.smoothing || (*options.smoothing >= 0 && std::isfinite(*options.smoothing)), "fit", "smoothing",
          options.smoothing.value_or(0), "must not be negative");
  require(!options.degree || (*options.degree >= -1 && *options.degree <= 8), "fit", "degree",
          options.degree.value_or(0), "must be -1 (none), 0, ... or 8");
  const std::vector<std::string> losses = fit_losses();
  require(std::find(losses.begin(), losses.end(), options.loss) != losses.end(), "fit", "loss", options.loss,
          "unknown; use one of " + joined(losses));
  require(options.periods.empty() || std::ssize(options.periods) == dimension, "fit", "periods", options.periods.size(),
          "one per axis, 0 for axes that are not periodic, or none at all");
  for (const double period : options.periods)
    require(period >= 0 && std::isfinite(period), "fit", "periods", period, "must be positive, or 0 for none");
  if (options.kernel != "auto") (void)Kernel(options.kernel, dimension, options.kernel_parameter);
  if (dimension > largest_dimension) {
    const std::string most = "; functions of more than " + std::to_string(largest_dimension) + " variables are ";
    require(
        options.method == "auto" || options.method == info_of(FitMethod::interpolate).name || !options.drift.empty(),
        "fit", "method", options.method, "is for fewer variables" + most + "fitted by one system: leave it out");
    require(options.centers == 0 || !options.drift.empty(), "fit", "centers", options.centers,
            "is for fewer variables" + most + "fitted by one system: leave it out");
    require(options.gradients.size() == 0, "fit", "gradients", "given", "are for fewer variables" + most + "without");
  }
}

}  // namespace csrbf
