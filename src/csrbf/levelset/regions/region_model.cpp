#include "csrbf/levelset/regions/region_model.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/levelset/regions/gamma_functions.hpp"
#include "csrbf/levelset/regions/likelihood_search.hpp"

#include <array>
#include <numbers>
#include <string>

namespace csrbf {
namespace {

constexpr std::array<std::string_view, 5> law_names = {"chan-vese", "gaussian", "generalized-gaussian", "rayleigh",
                                                       "gamma"};

bool is_one_sided(IntensityLaw law) {
  return law == IntensityLaw::rayleigh || law == IntensityLaw::gamma;
}

// The parameters of a law around `location` that have the moments of the histogram.
RegionModel with_moments(IntensityLaw law, const Histogram& histogram, double location) {
  RegionModel model{law, location, 1, 2};
  const double width = histogram.bins.width();
  double absolute = 0;
  double total = 0;
  for (Index k = 0; k < std::ssize(histogram.counts); ++k) {
    const double count = histogram.counts[k];
    absolute += count * std::abs(histogram.bins.center(k) - location);
    total += count;
  }
  absolute = std::max(absolute / total, .25 * width);
  const double square = std::max(histogram.moment(2, location), .1 * width * width);
  switch (law) {
    case IntensityLaw::chan_vese:
      break;
    case IntensityLaw::gaussian:
      model.scale = std::sqrt(square);
      break;
    case IntensityLaw::generalized_gaussian:
      model.shape = shape_of_moment_ratio(square / (absolute * absolute));
      model.scale = absolute * std::exp(std::lgamma(1 / model.shape) - std::lgamma(2 / model.shape));
      break;
    case IntensityLaw::rayleigh:
      model.scale = std::sqrt(.5 * square);
      break;
    case IntensityLaw::gamma: {
      const double mean = std::max(histogram.mean() - location, .5 * width);
      const double variance = std::max(histogram.moment(2, location + mean), .25 * width * width);
      model.shape = std::clamp(mean * mean / variance, smallest_gamma_shape, largest_gamma_shape);
      model.scale = mean / model.shape;
    }
  }
  return model;
}

// A law of exponential tails with the quartiles of the histogram, which clipped tails do not change.
RegionModel with_quartiles(const Histogram& histogram) {
  const double range = histogram.quantile(.75) - histogram.quantile(.25);
  const double scale = std::max(.5 * range / std::numbers::ln2, .25 * histogram.bins.width());
  return {IntensityLaw::generalized_gaussian, histogram.quantile(.5), scale, 1};
}

// The centre of the three neighbouring bins with most voxels.
double mode_of(const Histogram& histogram) {
  const auto& counts = histogram.counts;
  double most = -1;
  Index mode = 0;
  for (Index k = 0; k < std::ssize(counts); ++k) {
    double sum = 0;
    for (Index i = std::max<Index>(0, k - 1); i <= std::min(std::ssize(counts) - 1, k + 1); ++i) sum += counts[i];
    if (sum <= most) continue;
    most = sum;
    mode = k;
  }
  return histogram.bins.center(mode);
}

// A law that spreads over the whole range.
RegionModel spread_out(IntensityLaw law, const IntensityBins& bins, const RegionModelOptions& options) {
  Histogram flat(bins);
  std::fill(flat.counts.begin(), flat.counts.end(), 1.0);
  return fit_region_model(law, flat, {.location = options.location});
}

void require_valid(IntensityLaw law, const Histogram& histogram, const RegionModelOptions& options) {
  constexpr const char* function = "fit_region_model";
  const IntensityBins& bins = histogram.bins;
  require(bins.hi > bins.lo && std::isfinite(bins.hi - bins.lo), function, "histogram.bins.hi - lo", bins.hi - bins.lo,
          "must be positive and finite");
  require(bins.count >= 1 && bins.count == std::ssize(histogram.counts), function, "histogram.counts.size()",
          histogram.counts.size(), "must be histogram.bins.count and positive");
  for (const double count : histogram.counts)
    require(std::isfinite(count), function, "histogram.counts", count, "must be finite");
  if (options.location)
    require(std::isfinite(*options.location), function, "location", *options.location, "must be finite");
  if (!options.start) return;
  const RegionModel& start = *options.start;
  require(start.law == law, function, "start.law", name_of(start.law), "must be the law that is fitted");
  require(std::isfinite(start.location), function, "start.location", start.location, "must be finite");
  require(start.scale > 0 && std::isfinite(start.scale), function, "start.scale", start.scale,
          "must be positive and finite");
  require(start.shape > 0 && std::isfinite(start.shape), function, "start.shape", start.shape,
          "must be positive and finite");
}

}  // namespace

IntensityLaw intensity_law(std::string_view name) {
  const auto found = std::find(law_names.begin(), law_names.end(), name);
  require(found != law_names.end(), "intensity_law", "name", name,
          "must be chan-vese, gaussian, generalized-gaussian, rayleigh or gamma");
  return static_cast<IntensityLaw>(found - law_names.begin());
}

std::string_view name_of(IntensityLaw law) {
  return law_names[static_cast<std::size_t>(law)];
}

RegionModel fit_region_model(IntensityLaw law, const Histogram& histogram, const RegionModelOptions& options) {
  require_valid(law, histogram, options);
  Histogram weights = histogram;
  for (double& count : weights.counts) count = std::max(0.0, count);  // what subtracting fractions may leave
  if (!(weights.total() > 0)) {
    if (options.start) return *options.start;
    if (law != IntensityLaw::chan_vese) return spread_out(law, histogram.bins, options);
  }
  if (law == IntensityLaw::chan_vese)
    return {.law = law, .location = options.location.value_or(weights.mean()), .scale = 1, .shape = 2};

  std::vector<RegionModel> starts;
  if (options.start) starts.push_back(*options.start);
  const double location = options.location.value_or(is_one_sided(law) ? histogram.bins.lo : weights.mean());
  starts.push_back(with_moments(law, weights, location));
  if (law == IntensityLaw::generalized_gaussian) {
    if (!options.location)
      for (const double center : {weights.quantile(.5), mode_of(weights)})
        starts.push_back(with_moments(law, weights, center));
    starts.push_back(with_quartiles(weights));
    if (options.location) starts.back().location = *options.location;
  }
  const bool moves = !is_one_sided(law) && !options.location;
  return likeliest_model(weights, starts, moves);
}

double shape_of_moment_ratio(double ratio) {
  // log ratio decreases and is convex in log b nearly everywhere: Newton's method, kept in a shrinking bracket.
  double lo = std::log(smallest_gaussian_shape);
  double hi = std::log(largest_gaussian_shape);
  const auto excess = [&](double log_b) {
    const double s = std::exp(-log_b);
    return std::lgamma(s) + std::lgamma(3 * s) - 2 * std::lgamma(2 * s) - std::log(ratio);
  };
  if (!(excess(lo) > 0)) return smallest_gaussian_shape;
  if (!(excess(hi) < 0)) return largest_gaussian_shape;
  double x = 0;                        // b = 1
  constexpr int most_steps = 60;       // bisection alone needs 46
  constexpr double precision = 1e-13;  // of log b
  for (int i = 0; i < most_steps && hi - lo > precision; ++i) {
    const double f = excess(x);
    (f > 0 ? lo : hi) = x;
    const double s = std::exp(-x);
    const double slope = -s * (digamma(s) + 3 * digamma(3 * s) - 4 * digamma(2 * s));
    double next = x - f / slope;
    if (!(next > lo && next < hi)) next = .5 * (lo + hi);
    if (std::abs(next - x) <= precision) return std::exp(next);
    x = next;
  }
  return std::exp(x);
}

}  // namespace csrbf
