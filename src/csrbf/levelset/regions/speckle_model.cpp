#include "csrbf/levelset/regions/speckle_model.hpp"

#include "csrbf/levelset/regions/region_cores.hpp"

#include <numbers>

namespace csrbf {
namespace {

constexpr double least_exponent = 0.01;      // as good as the logarithm
constexpr double largest_tail_exponent = 3;  // beyond the power, 2, with room for errors; by hand

// Moment of the amplitude to the power of n exponents; amplitudes of mean power 1 are Rayleigh.
double moment(double exponent, int n) {
  return std::tgamma(1 + 0.5 * n * exponent);
}

// Standard deviation over mean of amplitude^exponent.
double variation(double exponent) {
  const double m = moment(exponent, 1);
  return std::sqrt(moment(exponent, 2) / (m * m) - 1);
}

double skewness(double exponent) {
  const double m = moment(exponent, 1), s = moment(exponent, 2), variance = s - m * m;
  return (moment(exponent, 3) - 3 * m * s + 2 * m * m * m) / (variance * std::sqrt(variance));
}

// The exponent with that variation, which ascends.
double exponent_of_variation(double wanted) {
  double lo = least_exponent, hi = largest_tail_exponent;
  constexpr int halvings = 40;  // to 3e-12
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (lo + hi);
    (variation(middle) < wanted ? lo : hi) = middle;
  }
  return lo;
}

struct Greys {
  double count = 0, mean = 0, sd = 0, skewness = 0;
};

Greys greys_of(std::span<const float> values, std::span<const std::uint8_t> cores, std::uint8_t label) {
  Greys greys;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (cores[i] != label) continue;
    ++greys.count;
    greys.mean += static_cast<double>(values[i]);
  }
  greys.mean /= std::max(1.0, greys.count);
  double squares = 0, cubes = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (cores[i] != label) continue;
    const double off = static_cast<double>(values[i]) - greys.mean;
    squares += off * off;
    cubes += off * off * off;
  }
  greys.sd = std::sqrt(squares / std::max(1.0, greys.count));
  greys.skewness = greys.sd > 0 ? cubes / greys.count / std::pow(greys.sd, 3) : 0;
  return greys;
}

// Correlation of the powers of voxels `lag` apart along an axis in the same region.
double correlation(std::span<const float> powers, const SpeckleModel& model, const Grid& grid,
                   std::span<const std::uint8_t> cores, std::size_t axis, Index lag) {
  const Index n = grid.size[axis];
  Index step = 1;
  for (std::size_t a = 0; a < axis; ++a) step *= grid.size[a];
  double products = 0, squares = 0;
  for (Index i = 0; i < grid.voxels(); ++i) {
    const auto here = static_cast<std::size_t>(i);
    if (cores[here] == no_region || i / step % n + lag >= n) continue;
    const auto there = static_cast<std::size_t>(i + lag * step);
    if (cores[there] != cores[here]) continue;
    const double mean = model.power[cores[here]];
    const double a = static_cast<double>(powers[here]) / mean - 1, b = static_cast<double>(powers[there]) / mean - 1;
    products += a * b;
    squares += 0.5 * (a * a + b * b);
  }
  return squares > 0 ? products / squares : 0;
}

// Fills in the grain along each axis; false when neighbours are independent, or voxels beyond the grain are not. The
// correlation of the power is the square of that of the amplitude, exp(-lag^2 / (4 sd^2)).
template <int Dim>
bool measure_grain(std::span<const float> powers, const Grid& grid, std::span<const std::uint8_t> cores,
                   SpeckleModel& model) {
  constexpr double least = 0.3, most = 0.97;  // correlation of neighbours: a grain of 0.65 to 4 voxels; by hand
  constexpr double none = 0.2;                // correlation beyond the grain that may be chance; by hand
  constexpr double independent = 0.05;        // correlation below: grains are no wider than voxels
  double largest = 0;
  for (std::size_t axis = 0; axis < Dim; ++axis) {
    const double alike = correlation(powers, model, grid, cores, axis, 1);
    largest = std::max(largest, alike);
    if (alike > most) return false;
    model.grain[axis] = alike > independent ? std::sqrt(-0.5 / std::log(alike)) : 0;
    const auto far = static_cast<Index>(std::ceil(3 * model.grain[axis])) + 1;
    if (correlation(powers, model, grid, cores, axis, far) > none) return false;
  }
  return largest > least;
}

}  // namespace

double SpeckleModel::power_of(double grey) const {
  return std::pow(std::max(0.0, (grey - black) / (mean - black)), 2 / exponent);
}

double SpeckleModel::voxels_per_grain() const {
  double voxels = 1;
  for (const double sd : grain) voxels *= std::max(1.0, std::sqrt(2 * std::numbers::pi) * sd);
  return voxels;
}

template <int Dim>
std::optional<SpeckleModel> find_speckle(std::span<const float> values, const Grid& grid,
                                         std::span<const std::uint8_t> labels) {
  // Chosen by hand; looser limits take other noise for speckle, tighter ones miss speckle that was filtered or clipped.
  constexpr Index border = 5;               // voxels at the border that hold echoes of both sides
  constexpr double enough = 500;            // voxels in a region
  constexpr double least_contrast = 0.5;    // difference of the means in deviations
  constexpr double least_variation = -0.1;  // difference of the deviations over that of the means: 0 for logarithms
  constexpr double bright_skewness = 0.4, dark_skewness = 0.8;  // largest misfit; the dark may be clipped at black
  std::array<Index, 3> width{0, 0, 0};
  std::fill_n(width.begin(), Dim, border);
  const std::vector<std::uint8_t> cores = region_cores(labels, grid.size, width);
  const std::array<Greys, 2> greys{greys_of(values, cores, 0), greys_of(values, cores, 1)};
  const std::size_t bright = greys[1].mean > greys[0].mean ? 1 : 0;
  const Greys &high = greys[bright], &low = greys[1 - bright];
  if (high.count < enough || low.count < enough) return {};
  const double gap = high.mean - low.mean;
  if (!(gap > least_contrast * high.sd)) return {};
  const double ratio = (high.sd - low.sd) / gap;
  if (ratio < least_variation || ratio > variation(largest_tail_exponent)) return {};
  SpeckleModel model;
  model.exponent = exponent_of_variation(ratio);
  const double expected = skewness(model.exponent);
  if (std::abs(high.skewness - expected) > bright_skewness || std::abs(low.skewness - expected) > dark_skewness)
    return {};
  model.mean = high.mean;
  model.black = high.mean - high.sd / variation(model.exponent);

  std::vector<float> powers(values.size());
  std::array<double, 2> sums{0, 0};
  for (std::size_t i = 0; i < powers.size(); ++i) {
    if (cores[i] > 1) continue;
    powers[i] = static_cast<float>(model.power_of(static_cast<double>(values[i])));
    sums[cores[i]] += static_cast<double>(powers[i]);
  }
  for (std::size_t k = 0; k < 2; ++k) model.power[k] = sums[k] / greys[k].count;
  if (!(model.power[1 - bright] > 0) || !(model.power[bright] > model.power[1 - bright])) return {};
  if (!measure_grain<Dim>(powers, grid, cores, model)) return {};
  return model;
}

template std::optional<SpeckleModel> find_speckle<2>(std::span<const float>, const Grid&,
                                                     std::span<const std::uint8_t>);
template std::optional<SpeckleModel> find_speckle<3>(std::span<const float>, const Grid&,
                                                     std::span<const std::uint8_t>);

}  // namespace csrbf
