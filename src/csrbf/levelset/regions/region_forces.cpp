#include "csrbf/levelset/regions/region_forces.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel_sum.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/levelset/image/box_mean.hpp"
#include "csrbf/levelset/regions/energy_table.hpp"
#include "csrbf/levelset/regions/intensity_classes.hpp"
#include "csrbf/levelset/regions/region_cores.hpp"
#include "csrbf/linalg/decompositions.hpp"

#include <utility>

namespace csrbf {
namespace {

constexpr int texture_window = 4;  // half width of the boxes in which textures are compared before there is a contour;
                                   // by hand: 81 pixels, some more than the 50 that distinguish two textures

}  // namespace

template <int Dim>
RegionForces<Dim>::RegionForces(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask,
                                IntensityLaw law, int regions, std::span<const float> prior)
    : ForceSource(regions, prior),
      values_(values),
      grid_(grid),
      mask_(mask),
      law_(law),
      bins_(choose_bins(values, 256, mask)),
      indices_(bin_indices(values, bins_)) {
  std::vector<std::uint8_t> labels(values.size(), 0);
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = inside(i) ? 0 : 255;
  all_ = region_histograms(indices_, labels, 1, bins_)[0];
  statistics_.means.assign(regions, Eigen::VectorXd::Zero(terms));
}

template <int Dim>
std::vector<std::uint8_t> RegionForces<Dim>::start() {
  const IntensityClasses classes = optimal_classes(all_, regions());
  std::array<std::uint8_t, 256> label_of{};
  for (Index bin = 0; bin < bins_.count; ++bin)
    label_of[bin] = static_cast<std::uint8_t>(
        std::upper_bound(classes.thresholds.begin(), classes.thresholds.end(), bins_.center(bin)) -
        classes.thresholds.begin());
  std::vector<std::uint8_t> labels(values_.size());
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = label_of[indices_[i]];
  if (regions() > 2 || (law_ != IntensityLaw::gaussian && law_ != IntensityLaw::generalized_gaussian)) return labels;

  // Regions of equal mean differ in the spread of their intensities.
  std::vector<std::uint8_t> settled = labels;
  double least = settle(settled);
  // Where intensities alone separate the regions, their borders are the sharper ones.
  constexpr double alike = 0.8;  // share of labels that boxes leave as they are; by hand
  double same = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) same += labels[i] == settled[i] ? 1 : 0;
  if (same < alike * static_cast<double>(labels.size())) labels.swap(settled);
  for (int moment = 1; moment <= 2; ++moment) {
    std::vector<std::uint8_t> others(labels.size());
    texture_labels(moment, others);
    const double energy = settle(others);
    if (energy < least) {
      least = energy;
      labels.swap(others);
    }
  }
  return labels;
}

// Classes of the local means of |I - mean|^moment.
template <int Dim>
void RegionForces<Dim>::texture_labels(int moment, std::vector<std::uint8_t>& labels) const {
  const double mean = all_.mean();
  std::vector<float> contrast(values_.size());
  for (std::size_t i = 0; i < contrast.size(); ++i) {
    const double off = std::abs(static_cast<double>(values_[i]) - mean);
    contrast[i] = static_cast<float>(moment == 1 ? off : off * off);
  }
  std::array<Index, 3> width{0, 0, 0};
  std::fill_n(width.begin(), Dim, texture_window);
  box_mean(contrast, grid_.size, width);
  const IntensityBins bins = choose_bins(contrast, 256, mask_);
  const double threshold = optimal_classes(histogram_of(contrast, bins), 2).thresholds[0];
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = static_cast<double>(contrast[i]) > threshold ? 1 : 0;
}

// A few rounds of statistics and classification of small boxes; returns the energy.
template <int Dim>
double RegionForces<Dim>::settle(std::vector<std::uint8_t>& labels) {
  constexpr int rounds = 4;  // by hand: the labels only start the descent
  std::array<Index, 3> width{0, 0, 0};
  std::fill_n(width.begin(), Dim, texture_window);
  std::vector<float> cost(values_.size());
  const std::array<Index, 3> window = std::exchange(window_, width);
  double energy = 0;
  for (int round = 0; round < rounds; ++round) {
    fit(labels);
    energy = force(1, 1, cost);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      labels[i] = cost[i] < 0 ? 1 : 0;
      energy += std::min(0.0, static_cast<double>(cost[i]));
    }
  }
  window_ = window;
  return energy;
}

template <int Dim>
void RegionForces<Dim>::fit(std::span<const std::uint8_t> labels) {
  saved_ = statistics_;
  std::vector<std::uint8_t> masked;
  if (!mask_.empty()) {
    masked.assign(labels.begin(), labels.end());
    for (std::size_t i = 0; i < masked.size(); ++i)
      if (mask_[i] == 0) masked[i] = 255;
    labels = masked;
  }
  fit_models(labels);
  if (degree_ > 0) fit_means(labels);
  make_tables();
}

// At borders a blurred image mixes the intensities of both sides. There they would widen the wider law until its region
// takes over; the means are not drawn to either side. Labels that are mostly border come from noise, which the laws
// include.
template <int Dim>
std::vector<Histogram> RegionForces<Dim>::histograms(std::span<const std::uint8_t> labels) const {
  std::vector<Histogram> whole = region_histograms(indices_, labels, regions(), bins_);
  const bool widens = law_ == IntensityLaw::gaussian || law_ == IntensityLaw::generalized_gaussian;
  if (!widens || border_ == 0) return whole;
  constexpr double enough = 0.5;  // share of each region that its core must hold; by hand
  std::array<Index, 3> width{0, 0, 0};
  std::fill_n(width.begin(), Dim, border_);
  std::vector<Histogram> cores = region_histograms(indices_, region_cores(labels, grid_.size, width), regions(), bins_);
  for (std::size_t k = 0; k < whole.size(); ++k)
    if (cores[k].total() < enough * whole[k].total()) return whole;
  return cores;
}

template <int Dim>
void RegionForces<Dim>::fit_models(std::span<const std::uint8_t> labels) {
  const std::vector<Histogram> parts = histograms(labels);
  const bool first = statistics_.models.empty();
  statistics_.models.resize(regions());
  for (std::size_t k = 0; k < parts.size(); ++k) {
    RegionModelOptions options;
    if (!first) options.start = statistics_.models[k];
    statistics_.models[k] = fit_region_model(law_, parts[k], options);
    statistics_.means[k].setZero();
    statistics_.means[k][0] = statistics_.models[k].location;
  }
  if (law_ != IntensityLaw::gaussian && law_ != IntensityLaw::generalized_gaussian) return;
  // Without noise any voxel of a blurred border would be infinitely unlikely.
  constexpr double least = 0.03;  // of the contrast; by hand: larger widens laws of little noise
  double lowest = bins_.hi, highest = bins_.lo;
  for (const RegionModel& model : statistics_.models) {
    lowest = std::min(lowest, model.location);
    highest = std::max(highest, model.location);
  }
  for (RegionModel& model : statistics_.models) model.scale = std::max(model.scale, least * (highest - lowest));
}

template <int Dim>
void RegionForces<Dim>::undo() {
  statistics_ = saved_;
  make_tables();
}

// In units of the range, where no square is too large or too small for a float.
template <int Dim>
void RegionForces<Dim>::make_tables() {
  const double range = bins_.hi - bins_.lo;
  tables_.clear();
  for (RegionModel model : statistics_.models) {
    model.location = (model.location - bins_.lo) / range;
    model.scale /= range;
    tables_.push_back(energy_table(model, {0, 1, bins_.count}));
  }
}

// 1, x, y, (z), then the products, of coordinates in [-1, 1].
template <int Dim>
typename RegionForces<Dim>::Terms RegionForces<Dim>::monomials(Index x, Index y, Index z) const {
  const std::array<Index, 3> voxel{x, y, z};
  Point<Dim> p;
  for (Index a = 0; a < Dim; ++a)
    p[a] = grid_.size[a] > 1 ? 2 * static_cast<double>(voxel[a]) / static_cast<double>(grid_.size[a] - 1) - 1 : 0;
  Terms t;
  t[0] = 1;
  t.template segment<Dim>(1) = p;
  for (int a = 0, term = Dim + 1; a < Dim; ++a)
    for (int b = a; b < Dim; ++b, ++term) t[term] = p[a] * p[b];
  return t;
}

// Of some of the voxels: enough for a few numbers.
template <int Dim>
std::vector<typename RegionForces<Dim>::Moments> RegionForces<Dim>::moments(
    std::span<const std::uint8_t> labels) const {
  constexpr Index enough = 50000;  // voxels sampled: errors of half a percent
  std::vector<Moments> sums(regions());
  const Index step = std::max<Index>(1, grid_.voxels() / enough) | 1;
  for (Index i = 0; i < grid_.voxels(); i += step) {
    const auto voxel = static_cast<std::size_t>(i);
    if (labels[voxel] >= sums.size() || !inside(voxel)) continue;
    Moments& sum = sums[labels[voxel]];
    const Terms t = monomials(i % grid_.size[0], i / grid_.size[0] % grid_.size[1], i / grid_.size[0] / grid_.size[1]);
    const auto value = static_cast<double>(values_[voxel]);
    sum.A.noalias() += t * t.transpose();
    sum.b += value * t;
    sum.squares += value * value;
  }
  return sums;
}

template <int Dim>
typename RegionForces<Dim>::Terms RegionForces<Dim>::Moments::fit(int used) const {
  Terms c = Terms::Zero();
  Eigen::MatrixXd left = A.topLeftCorner(used, used);
  left.diagonal().array() += 1e-9 * count();  // ridge, for regions within a row
  c.head(used) = solve(Eigen::LDLT<Eigen::MatrixXd>(left), Eigen::VectorXd(b.head(used)));
  return c;
}

template <int Dim>
void RegionForces<Dim>::fit_means(std::span<const std::uint8_t> labels) {
  const int used = degree_ == 1 ? Dim + 1 : terms;
  const std::vector<Moments> sums = moments(labels);
  for (std::size_t k = 0; k < sums.size(); ++k) {
    if (sums[k].count() < 10.0 * used) continue;  // too few: the constant stays
    const Terms c = sums[k].fit(used);
    statistics_.means[k] = c;
    const double variance = (sums[k].squares - c.dot(sums[k].b)) / sums[k].count();
    statistics_.models[k].scale = std::max(std::sqrt(std::max(variance, 0.0)), 0.25 * bins_.width());
  }
}

// From second differences along x.
template <int Dim>
double RegionForces<Dim>::noise_variance() const {
  constexpr Index enough = 50000;  // voxels sampled: errors of half a percent
  std::vector<double> differences;
  for (Index i = 1; i + 1 < grid_.voxels(); i += std::max<Index>(1, grid_.voxels() / enough) | 1) {
    const Index x = i % grid_.size[0];
    const auto voxel = static_cast<std::size_t>(i);
    if (x == 0 || x + 1 == grid_.size[0] || !inside(voxel)) continue;
    differences.push_back(static_cast<double>(std::abs(values_[voxel - 1] - 2 * values_[voxel] + values_[voxel + 1])));
  }
  if (differences.empty()) return 0;
  const double sd = median(differences) / median_of_normal;
  return sd * sd / 6;
}

template <int Dim>
double RegionForces<Dim>::shading_explains(std::span<const std::uint8_t> labels) const {
  constexpr double least_variation = 0.05;  // of the contrast: below, constants are as good; by hand
  const std::vector<Moments> sums = moments(labels);
  double constant = 0, linear = 0, count = 0, variation = 0, lowest = bins_.hi, highest = bins_.lo;
  for (const Moments& sum : sums) {
    if (sum.count() < 10.0 * (Dim + 1)) continue;
    const Terms c = sum.fit(Dim + 1);
    const double mean = sum.b[0] / sum.count();
    constant += sum.squares - mean * sum.b[0];
    linear += sum.squares - c.dot(sum.b);
    count += sum.count();
    variation = std::max(variation, c.template segment<Dim>(1).norm() / std::sqrt(3.0));  // root mean square
    lowest = std::min(lowest, mean);
    highest = std::max(highest, mean);
  }
  if (variation < least_variation * (highest - lowest)) return 0;
  const double systematic = constant - count * noise_variance();
  return systematic > 0.01 * constant ? (constant - linear) / systematic : 0;
}

template <int Dim>
double RegionForces<Dim>::force(int k, double scale, std::span<float> force) const {
  const bool shaded = degree_ > 0 && (law_ == IntensityLaw::chan_vese || law_ == IntensityLaw::gaussian);
  const double others = shaded ? shaded_force(k, scale, force) : table_force(k, scale, force);
  if (window_[0] > 0) {
    box_mean(force, grid_.size, window_);
    if (!mask_.empty())
      for (std::size_t i = 0; i < force.size(); ++i)
        if (mask_[i] == 0) force[i] = 0;
  }
  return others;
}

template <int Dim>
double RegionForces<Dim>::table_force(int k, double scale, std::span<float> force) const {
  const auto bins = static_cast<std::size_t>(bins_.count);
  std::vector<float> others(bins, std::numeric_limits<float>::infinity()), table(bins);
  for (std::size_t l = 0; l < tables_.size(); ++l) {
    if (static_cast<int>(l) == k) continue;
    for (std::size_t bin = 0; bin < bins; ++bin) others[bin] = std::min(others[bin], tables_[l][bin]);
  }
  for (std::size_t bin = 0; bin < bins; ++bin)
    table[bin] = static_cast<float>(static_cast<double>(tables_[k][bin] - others[bin]) / scale);
  look_up_energies(values_, table, bins_, force);
  if (!mask_.empty())
    for (std::size_t i = 0; i < force.size(); ++i)
      if (mask_[i] == 0) force[i] = 0;
  return total_energy(others, all_);
}

template <int Dim>
double RegionForces<Dim>::shaded_force(int k, double scale, std::span<float> force) const {
  const double range = bins_.hi - bins_.lo;
  const auto cost = [&](std::size_t l, double value, double mean) {
    const double off = (value - mean) / range;
    if (law_ == IntensityLaw::chan_vese) return off * off;
    const double sd = statistics_.models[l].scale / range;
    return 0.5 * off * off / (sd * sd) + std::log(sd);
  };
  // Along a row the means are parabolas in x.
  return parallel_sum(grid_.size[1] * grid_.size[2], 8, [&](Index begin, Index end) {
    double sum = 0;
    for (Index row = begin; row < end; ++row)
      for (Index x = 0; x < grid_.size[0]; ++x) {
        const auto i = static_cast<std::size_t>(x + grid_.size[0] * row);
        force[i] = 0;
        if (!inside(i)) continue;
        const Terms t = monomials(x, row % grid_.size[1], row / grid_.size[1]);
        const auto value = static_cast<double>(values_[i]);
        double mine = 0, others = std::numeric_limits<double>::infinity();
        for (std::size_t l = 0; l < statistics_.means.size(); ++l) {
          const double here = cost(l, value, t.dot(statistics_.means[l]));
          if (static_cast<int>(l) == k)
            mine = here;
          else
            others = std::min(others, here);
        }
        force[i] = static_cast<float>((mine - others) / scale);
        sum += others;
      }
    return sum;
  });
}

template class RegionForces<2>;
template class RegionForces<3>;

}  // namespace csrbf
