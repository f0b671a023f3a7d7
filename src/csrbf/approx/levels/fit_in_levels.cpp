#include "csrbf/approx/levels/fit_in_levels.hpp"

#include "csrbf/approx/levels/error_bounded.hpp"
#include "csrbf/approx/levels/fixed_budget.hpp"
#include "csrbf/approx/levels/least_squares.hpp"
#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/approx/levels/multilevel.hpp"
#include "csrbf/approx/levels/pca_multiresolution.hpp"

#include <algorithm>
#include <stdexcept>

namespace csrbf {
namespace {

template <int Dim>
class LevelsFitter {
 public:
  LevelsFitter(const Samples<Dim>& samples, const FitOptions& options, FitReport& report)
      : samples_(samples), options_(options), report_(report) {}

  LevelFit<Dim> fit(FitMethod method) {
    switch (method) {
      case FitMethod::least_squares:
        return least_squares(samples_, options_of<LeastSquaresOptions>());
      case FitMethod::fixed_budget:
        return fixed_budget(samples_, options_of<FixedBudgetOptions>());
      case FitMethod::multilevel:
        return levels();
      case FitMethod::pca_multiresolution:
        return clusters();
      case FitMethod::error_bounded:
        return within_tolerance();
      default:
        throw std::logic_error("fit_in_levels: another method");
    }
  }

 private:
  template <class Options>
  void set_kernel(Options& options) {
    if (options_.kernel != "auto") options.kernel = options_.kernel;
    if (options_.smoothing) options.lambda0 = *options_.smoothing;
    options.progress = options_.progress;
    report_.kernel = options.kernel;
  }

  template <class Options>
  Options options_of() {
    Options options;
    set_kernel(options);
    options.centers = options_.centers;
    return options;
  }

  LevelFit<Dim> levels() {
    auto options = options_of<MultilevelOptions>();
    options.tolerance = options_.tolerance;
    if (options_.smoothing.value_or(0) > 0) options.solve = LevelSolve::ridge;
    return multilevel(samples_, options);
  }

  LevelFit<Dim> clusters() {
    PcaMultiresolutionOptions options;
    set_kernel(options);
    if (options_.tolerance > 0) options.tolerance = options_.tolerance;
    if (options_.centers > 0) options.cluster_size = std::max<Index>(1, samples_.size() / options_.centers);
    return pca_multiresolution(samples_, options);
  }

  LevelFit<Dim> within_tolerance() {
    auto options = options_of<ErrorBoundedOptions>();
    if (options_.tolerance > 0) options.tolerance = options_.tolerance;
    return error_bounded(samples_, options);
  }

  const Samples<Dim>& samples_;
  const FitOptions& options_;
  FitReport& report_;
};

}  // namespace

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> fit_in_levels(const Samples<Dim>& samples, const FitOptions& options,
                                                             FitMethod method, FitReport& report) {
  const LevelFit<Dim> fit = LevelsFitter<Dim>(samples, options, report).fit(method);
  report.levels = static_cast<Index>(fit.levels.size());
  report.centers = 0;
  for (const auto& level : fit.fields.front()->levels()) report.centers += level->basis().size();
  for (const LevelReport& level : fit.levels) report.support = std::max(report.support, level.largest_support);
  report.smoothing = fit.levels.front().lambda0;
  if (!fit.converged) report.warnings.emplace_back(tolerance_missed);
  return fit.model();
}

#define CSRBF_INSTANTIATE(Dim)                                                                                       \
  template std::vector<std::shared_ptr<const Field<Dim>>> fit_in_levels<Dim>(const Samples<Dim>&, const FitOptions&, \
                                                                             FitMethod, FitReport&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
