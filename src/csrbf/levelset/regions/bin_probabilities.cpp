#include "csrbf/levelset/regions/bin_probabilities.hpp"

#include "csrbf/core/simd.hpp"
#include "csrbf/kernels/vector_math.hpp"
#include "csrbf/levelset/regions/gamma_functions.hpp"

#include <numbers>

namespace csrbf {
namespace {

constexpr double largest_exponent = 700;  // exp(-700) is as good as 0, and its products stay finite

// exp(-|t|^b) and |t|^b log(|t|^b) times it at t_0 + k dt.
CSRBF_ALWAYS_INLINE void generalized_gaussian_values(double t0, double dt, Index n, double b, double* value,
                                                     double* slope) {
  for (Index k = 0; k < n; ++k) {
    const double t = std::abs(t0 + static_cast<double>(k) * dt);
    const double log_z = b * vector_log(t > 1e-300 ? t : 1e-300);
    double z = vector_exp(log_z);
    z = z < largest_exponent ? z : largest_exponent;
    value[k] = vector_exp(-z);
    slope[k] = value[k] * z * log_z;
  }
}

// t^(s - 1) exp(-t) / Gamma(s) and log t times it at t_0 + k dt; 0 for t <= 0.
CSRBF_ALWAYS_INLINE void gamma_values(double t0, double dt, Index n, double s, double log_gamma, double* value,
                                      double* slope) {
  for (Index k = 0; k < n; ++k) {
    const double t = t0 + static_cast<double>(k) * dt;
    const double log_t = vector_log(t > 1e-300 ? t : 1e-300);
    const double density = vector_exp((s - 1) * log_t - t - log_gamma);
    value[k] = t > 0 ? density : 0;
    slope[k] = value[k] * log_t;
  }
}

struct Rule {
  double node;  // in a bin of unit width
  double weight;
};
constexpr std::array<Rule, 3> gauss_legendre = {Rule{.1127016653792583, 5. / 18}, Rule{.5, 8. / 18},
                                                Rule{.8872983346207417, 5. / 18}};

// Share below t and its derivative by the logarithm of the shape.
struct Share {
  double value = 0;
  double by_shape = 0;
};

// By central differences: errors of about 1e-10, where probabilities below 1e-8 do not matter.
template <class Function>
Share share(const Function& below, double t, double shape) {
  constexpr double step = 1e-4;  // of log shape: balances truncation, step^2, and rounding, 1e-14 / step
  const double more = below(t, shape * std::exp(step));
  const double less = below(t, shape * std::exp(-step));
  return {below(t, shape), (more - less) / (2 * step)};
}

// The bins whose integrals the quadrature does not get, [begin, end), and the end bins by the distribution function.
template <class Function>
void integrate_exactly(const Function& below, double t0, double dt, double shape, Index begin, Index end,
                       BinProbabilities& result) {
  const Index n = result.values.size();
  const auto at = [&](Index edge) { return share(below, t0 + static_cast<double>(edge) * dt, shape); };
  const auto store = [&](Index k, const Share& left, const Share& right) {
    result.values[k] = std::max(0.0, right.value - left.value);
    result.derivatives(k, 2) = right.by_shape - left.by_shape;
  };
  store(0, {}, at(1));
  store(n - 1, at(n - 1), {1, 0});
  begin = std::clamp<Index>(begin, 1, n - 1);
  end = std::clamp<Index>(end, begin, n - 1);
  if (begin == end) return;
  Share left = at(begin);
  for (Index k = begin; k < end; ++k) {
    const Share right = at(k + 1);
    store(k, left, right);
    left = right;
  }
}

Index bin_of(double t, double t0, double dt, Index n) {
  return static_cast<Index>(std::clamp(std::floor((t - t0) / dt), -4.0, static_cast<double>(n + 4)));
}

void generalized_gaussian(const RegionModel& model, double b, const IntensityBins& bins, BinProbabilities& result) {
  const Index n = bins.count;
  const double t0 = (bins.lo - model.location) / model.scale;
  const double dt = bins.width() / model.scale;
  const double norm = .5 / std::tgamma(1 + 1 / b);
  Eigen::ArrayXd value(n + 1);
  Eigen::ArrayXd slope(n + 1);

  result.values.setZero();
  result.derivatives.setZero();
  for (const Rule& rule : gauss_legendre) {
    simd<generalized_gaussian_values>(t0 + rule.node * dt, dt, n, b, value.data(), slope.data());
    result.values.array() += rule.weight * dt * norm * value.head(n);
    result.derivatives.col(2).array() -= rule.weight * dt * norm * slope.head(n);
  }
  result.derivatives.col(2) += digamma(1 + 1 / b) / b * result.values;
  const auto below = [](double t, double shape) {
    const GammaShares shares = gamma_shares(1 / shape, std::pow(std::abs(t), shape));
    return t < 0 ? .5 * shares.above : .5 + .5 * shares.below;
  };
  const Index peak = bin_of(0, t0, dt, n);
  integrate_exactly(below, t0, dt, b, peak - 2, peak + 3, result);

  simd<generalized_gaussian_values>(t0, dt, n + 1, b, value.data(), slope.data());
  value *= norm;
  value[0] = value[n] = 0;  // the end bins reach to infinity
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(n + 1, t0, t0 + static_cast<double>(n) * dt);
  slope = t * value;
  result.derivatives.col(0).array() = value.head(n) - value.tail(n);
  result.derivatives.col(1).array() = slope.head(n) - slope.tail(n);
}

void gamma(const RegionModel& model, const IntensityBins& bins, BinProbabilities& result) {
  const Index n = bins.count;
  const double k = model.shape;
  const double t0 = (bins.lo - model.location) / model.scale;
  const double dt = bins.width() / model.scale;
  const double log_gamma = std::lgamma(k);
  Eigen::ArrayXd value(n + 1);
  Eigen::ArrayXd slope(n + 1);

  result.values.setZero();
  result.derivatives.setZero();
  for (const Rule& rule : gauss_legendre) {
    simd<gamma_values>(t0 + rule.node * dt, dt, n, k, log_gamma, value.data(), slope.data());
    result.values.array() += rule.weight * dt * value.head(n);
    result.derivatives.col(2).array() += rule.weight * dt * k * slope.head(n);
  }
  result.derivatives.col(2) -= k * digamma(k) * result.values;
  const auto below = [](double t, double shape) { return gamma_shares(shape, t).below; };
  const Index first = bin_of(0, t0, dt, n);
  integrate_exactly(below, t0, dt, k, first, first + 3, result);

  simd<gamma_values>(t0, dt, n + 1, k, log_gamma, value.data(), slope.data());
  const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(n + 1, t0, t0 + static_cast<double>(n) * dt);
  value = (t > 0).select(t * value, 0);
  value[0] = value[n] = 0;
  result.derivatives.col(1).array() = value.head(n) - value.tail(n);
}

void rayleigh(const RegionModel& model, const IntensityBins& bins, BinProbabilities& result) {
  const Index n = bins.count;
  const double t0 = (bins.lo - model.location) / model.scale;
  const double dt = bins.width() / model.scale;
  result.derivatives.setZero();
  double above = 1;
  double by_scale = 0;
  for (Index k = 0; k < n; ++k) {
    const double t = std::max(0.0, t0 + static_cast<double>(k + 1) * dt);
    const double next = k + 1 < n ? std::exp(-.5 * t * t) : 0;
    const double next_by_scale = t * t * next;
    result.values[k] = above - next;
    result.derivatives(k, 1) = by_scale - next_by_scale;
    above = next;
    by_scale = next_by_scale;
  }
}

}  // namespace

void bin_probabilities(const RegionModel& model, const IntensityBins& bins, BinProbabilities& result) {
  result.values.resize(bins.count);
  result.derivatives.resize(bins.count, 3);
  if (bins.count == 1) {
    result.values.setOnes();
    result.derivatives.setZero();
  } else if (model.law == IntensityLaw::rayleigh) {
    rayleigh(model, bins, result);
  } else if (model.law == IntensityLaw::gamma) {
    gamma(model, bins, result);
  } else if (model.law == IntensityLaw::gaussian) {
    RegionModel scaled = model;
    scaled.scale *= std::numbers::sqrt2;
    generalized_gaussian(scaled, 2, bins, result);
    result.derivatives.col(0) /= std::numbers::sqrt2;
  } else {
    generalized_gaussian(model, model.shape, bins, result);
  }
  constexpr double clean = 1 - BinProbabilities::contamination;
  result.values.array() =
      clean * result.values.array() + BinProbabilities::contamination / static_cast<double>(bins.count);
  result.derivatives *= clean;
}

}  // namespace csrbf
