#include "csrbf/approx/fit_by_method.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"
#include "csrbf/approx/kriging/center_fit.hpp"
#include "csrbf/approx/kriging/fill_gaps.hpp"
#include "csrbf/approx/left_out/left_out_blocks.hpp"
#include "csrbf/approx/levels/fit_in_levels.hpp"
#include "csrbf/approx/moving/along_tracks.hpp"
#include "csrbf/approx/samples/average_field.hpp"
#include "csrbf/approx/samples/blended_field.hpp"
#include "csrbf/approx/samples/deviation.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/approx/unity/local_variance.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

namespace csrbf {
namespace {

constexpr double value_rounding = 1e-12;  // relative

// One fit in scaled coordinates; fills the report.
template <int Dim>
class Fitter {
 public:
  Fitter(const Samples<Dim>& samples, const FitOptions& options, FitMethod method, const LearnedCovariance* learned,
         FitReport& report)
      : samples_(samples), options_(options), method_(method), learned_(learned), report_(report) {}

  MethodFields<Dim> fit() {
    Fields components = fit_components();
    return {std::move(components), std::move(variances_), method_, std::move(noise_), std::move(outside_gaps_)};
  }

 private:
  using Fields = std::vector<std::shared_ptr<const Field<Dim>>>;

  Fields fit_components() {
    if constexpr (Dim > largest_dimension) {
      if (learned_ != nullptr && samples_.size() > InterpolateOptions{}.dense_limit) {
        const AxisCovariance<Dim> covariance{learned_->kernel, Point<Dim>::Constant(learned_->support),
                                             learned_->nugget, options_.degree.value_or(learned_->degree)};
        const double at_least = fewest_centers * fewest_centers * static_cast<double>(samples_.size());
        const CenterOptions options{.affordable = std::max(more_affordable, at_least), .progress = options_.progress};
        if (covariance.degree >= 0 && covariance.degree <= 1)
          if (auto fit = fit_at_centers(without_zero_weights(samples_), covariance, options)) return at_centers(*fit);
      }
      require(samples_.size() <= InterpolateOptions{}.dense_limit, "fit", "samples", samples_.size(),
              "more than 4000 of more than six variables need kernel, smoothing and degree left to choose");
      return interpolant();
    } else {
      return components_by_method();
    }
  }

  Fields components_by_method() {
    if (options_.method == "auto" && options_.tolerance > 0 && options_.centers == 0 &&
        samples_.size() > few_samples(Dim)) {
      Fields fields = thinned_partition();
      if (!fields.empty()) return fields;
    }
    switch (method_) {
      case FitMethod::interpolate:
        return interpolant();
      case FitMethod::partition_of_unity:
        return patches_or_tracks();
      case FitMethod::along_tracks:
        return along_tracks_alone();
      case FitMethod::moving_least_squares:
        return moving();
      default:
        return fit_in_levels(samples_, options_, method_, report_);
    }
  }

  // A partition of unity of a share of the samples that is within the tolerance at all of them; none if there is none.
  Fields thinned_partition() {
    if (options_.kernel != "auto" && Kernel(options_.kernel, Dim).order() > 0) return {};
    struct Attempt {
      Index stride;
      double mean_error;  // as a share of the tolerance, which is for the largest one
    };
    constexpr std::array<Attempt, 4> attempts = {{{64, 1e-2}, {8, 1e-2}, {1, 1e-2}, {1, 1e-5}}};
    const FitReport before = report_;
    const std::vector<Index> order = morton_order<Dim>(samples_.points);
    for (const auto& [stride, mean_error] : attempts) {
      if (samples_.size() / stride < few_samples(Dim)) continue;
      const Samples<Dim> share = merge_duplicates(subset(order, 0, stride)).samples;
      PartitionOfUnityOptions local = partition_options(options_);
      local.accuracy = mean_error * options_.tolerance;
      Fields fields = partition(share, local);
      const Index stride_of_test = std::max<Index>(1, samples_.size() / tested_first);
      if (holds(fields, subset(order, stride / 2, stride_of_test)) && holds(fields, samples_)) {
        method_ = FitMethod::partition_of_unity;
        report_.samples_fitted = share.size();
        Fields right_in_gaps = filled(share);
        if (holds(right_in_gaps, samples_)) return right_in_gaps;
        variances_ = local_variance(share, last_fit_);
        return fields;
      }
    }
    report_ = before;
    variances_.clear();
    return {};
  }

  // Every stride-th sample from `first` on, and those that span the box of all.
  Samples<Dim> subset(const std::vector<Index>& order, Index first, Index stride) const {
    std::vector<Index> chosen(2 * Dim);
    for (Index a = 0; a < Dim; ++a) {
      samples_.points.row(a).minCoeff(&chosen[2 * a]);
      samples_.points.row(a).maxCoeff(&chosen[2 * a + 1]);
    }
    for (Index i = std::min(first, samples_.size() - 1); i < samples_.size(); i += stride) chosen.push_back(order[i]);
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    return chosen_samples(samples_, chosen);
  }

  // Whether every sample is within the tolerance.
  bool holds(const Fields& fields, const Samples<Dim>& samples) const {
    for (std::size_t c = 0; c < fields.size(); ++c) {
      const Eigen::VectorXd f = fields[c]->evaluate(samples.points).value;
      if (!((f - samples.values.col(static_cast<Index>(c))).cwiseAbs().maxCoeff() <= options_.tolerance)) return false;
    }
    return true;
  }

  Fields partition(const Samples<Dim>& samples, const PartitionOfUnityOptions& options) {
    if (options_.kernel != "auto")
      require(Kernel(options_.kernel, Dim).order() == 0, "fit", "kernel", options_.kernel,
              "is only conditionally positive definite; a partition of unity needs another one, such as wendland-c4");
    const PartitionOfUnityFit<Dim> fit = partition_of_unity(samples, options);
    const LocalOptions& local = fit.report.local;
    report_.kernel = local.kernel;
    report_.degree = local.degree;
    report_.centers = fit.report.centers;
    report_.partition = {fit.report.patches, local.samples, local.anisotropy};
    report_.smoothing = local.smoothing;
    report_.cross_validation_rmse = fit.report.cross_validation_rmse;
    last_fit_ = fit;
    return fit.fields();
  }

  // What partition() has fitted, also right in gaps between the samples.
  Fields filled(const Samples<Dim>& samples, bool tracks = false) {
    FilledGaps<Dim> filled = fill_gaps(samples, last_fit_, local_variance(samples, last_fit_), tracks);
    report_.partition->patches = filled.fit.report.patches;
    variances_ = std::move(filled.variances);
    outside_gaps_ = filled.outside;
    return filled.fields();
  }

  bool is_free() const {
    return options_.method == "auto" && options_.kernel == "auto" && !options_.degree && !options_.smoothing;
  }

  // Whether patches do not meet their samples, which may be noisy. Where they do, functions are rough.
  bool patches_smooth() const {
    const LocalOptions& local = last_fit_.report.local;
    return (local.smoothing > 0 || local.centers < local.samples) &&
           report_.cross_validation_rmse > noise_matters * weighted_deviation(samples_.values, samples_.all_weights());
  }

  Fields at_centers(const CenterFit<Dim>& fit) {
    const AxisCovariance<Dim>& covariance = fit.covariance;
    method_ = FitMethod::interpolate;
    noise_ = fit.noise;
    variances_ = fit.variances;
    report_.kernel = covariance.kernel.name();
    report_.degree = covariance.degree;
    report_.support = covariance.lengths.minCoeff();
    report_.smoothing = covariance.nugget;
    report_.centers = fit.centers;
    report_.partition.reset();
    report_.cross_validation_rmse = fit.error;
    std::vector<double>& scales = report_.axis_scales;
    if (covariance.axes && std::adjacent_find(scales.begin(), scales.end(), std::not_equal_to<>()) != scales.end())
      return fit.components;  // turned after they were scaled: no axes of the coordinates
    for (Index a = 0; a < std::ssize(scales); ++a) scales[a] *= covariance.lengths[a] / report_.support;
    if (covariance.axes)
      for (const auto& axis : covariance.axes->colwise()) report_.axes.emplace_back(axis.begin(), axis.end());
    return fit.components;
  }

  bool tracks_may_matter() const {
    const LocalOptions& local = last_fit_.report.local;
    const bool rough = local.centers == local.samples && local.degree <= 1;
    const bool exact = report_.cross_validation_rmse <= value_rounding * samples_.values.cwiseAbs().maxCoeff();
    return Dim > 1 && is_free() && rough && !exact && samples_.size() >= fewest_for_tracks;
  }

  std::optional<Fields> at_centers_if_better() {
    if (!is_free() || !options_.periods.empty()) return std::nullopt;
    CenterOptions options{.error_to_beat = report_.cross_validation_rmse, .progress = options_.progress};
    options.one_length = !options_.scale_axes;
    const auto fit = better_at_centers(without_zero_weights(samples_), last_fit_.report.local, options);
    return fit ? std::optional(at_centers(*fit)) : std::nullopt;
  }

  Fields patches_or_tracks() {
    partition(samples_, partition_options(options_));
    if (patches_smooth())
      if (auto fields = at_centers_if_better()) return *fields;
    const auto tracks = tracks_may_matter() ? better_along_tracks(samples_, last_fit_.report.local) : std::nullopt;
    Fields patches = filled(samples_, tracks.has_value());
    if (!tracks) return patches;
    method_ = FitMethod::along_tracks;
    Fields fields = blend(moving(), patches, tracks->shares);
    report_.cross_validation_rmse = tracks->held_out_rmse;
    Fields variances = blend(variances_, Fields(variances_.size()), tracks->ratios);
    if (outside_gaps_) {
      fields = blend(fields, patches, {outside_gaps_});
      variances = blend(variances, variances_, {outside_gaps_});
    }
    variances_ = std::move(variances);
    return fields;
  }

  Fields along_tracks_alone() {
    Fields fields = moving();  // first: it knows which kernels it takes
    const FitReport before = report_;
    partition(samples_, {.progress = options_.progress});
    const Fields patches = filled(samples_, true);
    report_ = before;
    report_.cross_validation_rmse = held_out_along_tracks(samples_, moving_options());
    if (outside_gaps_) fields = blend(fields, patches, {outside_gaps_});
    variances_ = errors_of<Dim>(fields, patches, variances_);
    return fields;
  }

  // `shares`: of the first fields; one for all, or one for each.
  static Fields blend(const Fields& one, const Fields& other, const Fields& shares) {
    Fields blended;
    for (std::size_t c = 0; c < one.size(); ++c)
      blended.push_back(std::make_shared<const BlendedField<Dim>>(one[c], other[c], shares[shares.size() > 1 ? c : 0]));
    return blended;
  }

  MovingLeastSquaresOptions moving_options() const {
    auto options = method_ == FitMethod::along_tracks ? along_tracks : MovingLeastSquaresOptions{};
    if (options_.kernel != "auto") options.kernel = options_.kernel;
    if (options_.degree) options.degree = *options_.degree;
    return options;
  }

  Fields moving() {
    const MovingLeastSquaresOptions options = moving_options();
    report_.kernel = options.kernel;
    report_.degree = options.degree;
    report_.centers = samples_.size();
    return moving_least_squares(samples_, options);
  }

  // Lengths of functions that the trend takes nearly are as long as can be: too long for the system.
  Interpolation<Dim> shortened(InterpolateOptions options) const {
    constexpr double shorter = 0.3;
    for (int attempt = 0; attempt < 5; ++attempt, options.support *= shorter) try {
        return interpolate(samples_, options);
      } catch (const SolverFailure&) {
      }
    return interpolate(samples_, options);
  }

  // Over that of a normal law: sigma itself is estimated, with so many degrees of freedom.
  static double variance_of_student(Index degrees) {
    const auto f = static_cast<double>(std::max<Index>(degrees, 4));
    return f / (f - 2);
  }

  // sigma^2 by the means of samples at the same points and by the scatter about these, which is noise.
  double with_replicates(const KrigingVariance<Dim>& variance, Index component) const {
    const Replicates& replicates = learned_->replicates;
    if (replicates.count == 0 || !(learned_->nugget > 0)) return variance.sigma2();
    const auto places = static_cast<double>(samples_.size());
    return (places * variance.sigma2() + replicates.squares[component] / learned_->nugget) /
           (places + static_cast<double>(replicates.count));
  }

  // Without noise the samples are met; whether there is any, leave-one-out tells.
  Fields interpolant() {
    InterpolateOptions options;
    options.kernel = options_.kernel;
    options.parameter = options_.kernel_parameter;
    options.smoothing = options_.smoothing.value_or(0);
    if (options_.degree) options.degree = *options_.degree;
    options.keep_weights = true;
    options.progress = options_.progress;
    options.largest_error = options_.tolerance;
    if (learned_ != nullptr) {
      options.kernel = learned_->kernel.name();
      options.parameter = learned_->kernel.parameter();
      options.support = learned_->support;
      options.smoothing = std::max(learned_->nugget, least_nugget);
      if (!options_.degree) options.degree = learned_->degree;
      options.require_degree = options_.degree.has_value();
    }
    if (options_.tolerance > 0) options.smoothing = options_.smoothing.value_or(0);
    Interpolation<Dim> best = learned_ != nullptr ? shortened(options) : interpolate(samples_, options);
    if (learned_ == nullptr && !options_.smoothing && options_.tolerance == 0 && samples_.size() > 2 * Dim) {
      options.smoothing.reset();
      Interpolation<Dim> smoothed = interpolate(samples_, options);
      const double deviation = weighted_deviation(samples_.values, samples_.all_weights());
      const bool is_noise = samples_.size() >= enough_to_tell && best.report.leave_one_out > explained * deviation;
      const double gain = is_noise ? 1 / smoother_gain : smoother_gain;
      if (smoothed.report.leave_one_out < gain * best.report.leave_one_out) best = std::move(smoothed);
    }
    report_.kernel = best.report.kernel;
    report_.degree = best.report.degree;
    report_.support = best.report.support;
    report_.smoothing = best.report.smoothing;
    report_.cross_validation_rmse = best.report.leave_one_out;
    if (best.report.limited_by_rounding) {
      std::ostringstream text;
      text << "the system of the kernel " << report_.kernel << " is ill conditioned: samples are met within "
           << std::setprecision(2) << best.report.residual << " only; a rougher kernel or smoothing > 0 does better";
      report_.warnings.push_back(text.str());
    }
    report_.centers = best.components.front()->basis().size();
    Eigen::VectorXd sigma2(std::ssize(best.variances));
    for (Index c = 0; c < sigma2.size(); ++c) {
      const KrigingVariance<Dim>& variance = *best.variances[static_cast<std::size_t>(c)];
      const double own = learned_ == nullptr ? variance.sigma2() : with_replicates(variance, c);
      noise_.push_back(std::sqrt(own * variance.power().smoothing()));
      if (learned_ == nullptr) continue;
      const double by_planes = learned_->sigma2.size() > 0 ? learned_->sigma2[c] : 0;
      sigma2[c] = learned_->growth[c] * variance_of_student(samples_.size() - 1 + learned_->replicates.count) *
                  (by_planes > clearly_more * own ? by_planes : own);
    }
    if (learned_ != nullptr && sigma2.size() > 0 && options_.periods.empty()) {  // which have no end
      options.support = report_.support;
      const std::vector<ErrorGrowth> growth = left_out_blocks(samples_, options, sigma2);
      for (std::size_t c = 0; c < growth.size(); ++c)
        best.variances[c] = best.variances[c]->with(sigma2[static_cast<Index>(c)], growth[c]);
    }
    variances_ = {best.variances.begin(), best.variances.end()};
    return {best.components.begin(), best.components.end()};
  }

  static constexpr double noise_matters = 1e-3;    // of the deviation of the values
  static constexpr double more_affordable = 4e10;  // see CenterOptions, where there are no patches
  static constexpr Index tested_first = 10'000, fewest_for_tracks = 1000, enough_to_tell = 50;  // samples
  static constexpr double clearly_more = 2;      // variance between the planes of a lattice than between its samples
  static constexpr double smoother_gain = 0.95;  // of the leave-one-out error, that makes smoothing worth it
  static constexpr double least_nugget = 1e-14;  // some roundings; systems that just pass without may be all rounding
  static constexpr double explained = 0.9;       // of the deviation of the values; above, samples need not be met

  const Samples<Dim>& samples_;
  const FitOptions& options_;
  FitMethod method_;
  const LearnedCovariance* learned_;
  Fields variances_ = {};
  std::vector<double> noise_ = {};  // of samples of weight 1
  FitReport& report_;
  PartitionOfUnityFit<Dim> last_fit_ = {};               // by partition()
  std::shared_ptr<const Field<Dim>> outside_gaps_ = {};  // by filled()
};

}  // namespace

FitMethod choose_method(const FitOptions& options, Index samples, int dimension) {
  if (const FitMethodInfo* given = find_fit_method(options.method)) return given->method;
  if (dimension > largest_dimension) return FitMethod::interpolate;
  if (options.tolerance > 0) return FitMethod::error_bounded;
  if (options.centers > 0) return FitMethod::fixed_budget;
  const bool needs_one_system = !std::isnan(options.kernel_parameter) ||
                                (options.kernel != "auto" && Kernel(options.kernel, dimension).order() > 0);
  return samples <= few_samples(dimension) || needs_one_system ? FitMethod::interpolate : FitMethod::partition_of_unity;
}

PartitionOfUnityOptions partition_options(const FitOptions& options) {
  PartitionOfUnityOptions local;
  if (options.kernel != "auto") local.kernel = options.kernel;
  local.degree = options.degree;
  local.smoothing = options.smoothing;
  local.progress = options.progress;
  return local;
}

template <int Dim>
MethodFields<Dim> fit_by_method(const Samples<Dim>& samples, const FitOptions& options, FitMethod method,
                                const LearnedCovariance* learned, FitReport& report) {
  return Fitter<Dim>(samples, options, method, learned, report).fit();
}

#define CSRBF_INSTANTIATE(Dim)                                                                     \
  template MethodFields<Dim> fit_by_method<Dim>(const Samples<Dim>&, const FitOptions&, FitMethod, \
                                                const LearnedCovariance*, FitReport&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
