#include "csrbf/levelset/partition/partition_model.hpp"

#include "csrbf/core/parallel_sum.hpp"
#include "csrbf/levelset/image/common_background.hpp"
#include "csrbf/levelset/partition/nearest_component.hpp"
#include "csrbf/levelset/regions/energy_table.hpp"
#include "csrbf/levelset/regions/label_code.hpp"
#include "csrbf/levelset/regions/label_runs.hpp"

#include <limits>
#include <numbers>

namespace csrbf {
namespace {

constexpr Index per_task = 1 << 14;      // voxels per task
constexpr double least_contrast = 0.1;   // of an object, of that of the regions; by hand: less is the surroundings
constexpr double least_resolved = 0.25;  // mean squared deviation: less is below what intensities resolve; by hand

int degree_of(MeanShape shape) {
  return shape == MeanShape::constant || shape == MeanShape::background ? 0 : shape == MeanShape::linear ? 1 : 2;
}

}  // namespace

PartitionPrice::PartitionPrice(std::span<const float> values, double lo, double hi, const Grid& grid,
                               std::span<const std::uint8_t> mask, const ContourWeight& weight, Index levels)
    : values_(values.size()), grid_(grid), mask_(mask), weight_(weight), bins_{0, 1, levels} {
  const double inverse = 1 / (hi - lo);
  parallel_for(std::ssize(values), per_task, [&](Index begin, Index end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      values_[i] =
          inside(i) ? static_cast<float>(std::clamp((static_cast<double>(values[i]) - lo) * inverse, 0.0, 1.0)) : 0.0F;
  });
  all_ = region_moments(values_, masked(std::vector<std::uint8_t>(values.size(), 0)), 0, grid_);
  count_ = all_.count();
}

void PartitionPrice::set_certainty(std::vector<float> certainty) {
  certainty_ = std::move(certainty);
  all_ = region_moments(values_, masked(std::vector<std::uint8_t>(values_.size(), 0)), 0, grid_, certainty_);
}

void PartitionPrice::set_grain(double voxels) {
  const double dimension = grid_.dimension(), edges = (dimension - 1) / dimension;
  const double factor = std::pow(grain_ / voxels, edges);
  weight_.length *= factor;
  edge_scale_ *= factor;
  grain_ = voxels;
}

// With a label that no region has outside the mask.
std::vector<std::uint8_t> PartitionPrice::masked(std::span<const std::uint8_t> labels) const {
  std::vector<std::uint8_t> result(labels.begin(), labels.end());
  for (std::size_t i = 0; i < mask_.size(); ++i)
    if (mask_[i] == 0) result[i] = 255;
  return result;
}

void PartitionPrice::set_seeds(SeedCosts seeds) {
  seeds_ = std::move(seeds);
  uncertain_.clear();
  for (std::size_t i = 0; i < seeds_.nats.size(); ++i)
    if (seeds_.labels[i] != 0 && !seeds_.is_certain(i) && inside(i)) uncertain_.push_back(i);
}

LabelMeasures PartitionPrice::measure(std::span<const std::uint8_t> labels, int regions) const {
  const std::vector<std::uint8_t> without_mask = mask_.empty() ? std::vector<std::uint8_t>() : masked(labels);
  const auto moments = [&](int k) {
    return region_moments(values_, mask_.empty() ? labels : without_mask, static_cast<std::uint8_t>(k), grid_,
                          certainty_);
  };
  LabelMeasures result;
  for (const std::size_t i : uncertain_)
    if (labels[i] + 1 != seeds_.labels[i]) result.price += static_cast<double>(seeds_.nats[i]);
  if (regions == 2) {
    result.regions = {all_, moments(1)};
    result.regions[0].add(result.regions[1], -1);
    result.price +=
        std::min(contour_price(labels, 1, grid_.size, weight_), label_code(labels, grid_, mask_) * edge_scale_) +
        place_price() * static_cast<double>(LabelRuns(labels, grid_).count_parts());
    return result;
  }
  for (int k = 0; k < regions; ++k) {
    result.regions.push_back(moments(k));
    // A contour between two regions is the border of both.
    result.price += 0.5 * contour_price(labels, static_cast<std::uint8_t>(k), grid_.size, weight_);
  }
  return result;
}

double PartitionPrice::fit(std::span<const std::uint8_t> labels, const LabelMeasures& measures,
                           const PartitionModel& model) {
  const std::size_t n = measures.regions.size();
  model_ = model;
  means_.assign(n, 0);
  counts_.assign(n, 0);
  fields_.assign(n, {});
  polynomials_.clear();
  for (std::size_t k = 0; k < n; ++k) {
    counts_[k] = measures.regions[k].count();
    if (counts_[k] < 3 * grain_) return std::numeric_limits<double>::infinity();
    means_[k] = measures.regions[k].mean();
  }
  const bool objects = model.shape == MeanShape::objects;
  const int degree = degree_of(model.shape);
  double parameters = model.own_deviations ? static_cast<double>(n) : 1;
  std::vector<double> squares;
  for (std::size_t k = 0; k < n; ++k) {
    const RegionMoments& region = measures.regions[k];
    polynomials_.emplace_back(region, objects && k == model.object_label ? 0 : degree, grid_);
    parameters += static_cast<double>(polynomials_[k].parameters());
    squares.push_back(polynomials_[k].residual(region));
  }
  if (objects) {
    fill_field(1 - model.object_label);
    parameters += fit_objects(labels, model.object_label) - 1;
    squares[model.object_label] = residual(labels, model.object_label);
  }
  if (model.shape == MeanShape::smooth)
    for (std::size_t k = 0; k < n; ++k) {
      fill_field(k);
      parameters += add_smooth_mean(labels, k);
      squares[k] = residual(labels, k);
    }
  if (model.shape == MeanShape::background) {
    parameters += fit_background(labels) - 1;
    for (std::size_t k = 0; k < n; ++k) squares[k] = residual(labels, k);
  }
  deviation_price_ = fit_deviations(squares);
  if (model.own_shapes) {
    deviation_price_ = fit_shapes(labels);
    parameters += model.own_deviations ? static_cast<double>(n) : 1;
  }
  deviation_price_ /= grain_;
  return measures.price + deviation_price_ + 0.5 * parameters * place_price();
}

double PartitionPrice::price_of_one_region(const PartitionModel& model) {
  model_ = model;
  means_ = {all_.mean()};
  counts_ = {count_};
  fields_.assign(1, {});
  polynomials_ = {MeanPolynomial(all_, degree_of(model.shape), grid_)};
  const std::vector<std::uint8_t> one(values_.size(), 0);
  double parameters = 1 + static_cast<double>(polynomials_[0].parameters()) + (model.own_shapes ? 1 : 0);
  double squares = polynomials_[0].residual(all_);
  if (model.shape == MeanShape::smooth) {
    fill_field(0);
    parameters += add_smooth_mean(one, 0);
  }
  if (model.shape == MeanShape::background) parameters += fit_background(one) - 1;
  if (!fields_[0].empty()) squares = residual(one, 0);
  deviation_price_ = fit_deviations({squares});
  if (model.own_shapes) deviation_price_ = fit_shapes(one);
  return deviation_price_ / grain_ + 0.5 * parameters * place_price();
}

void PartitionPrice::fill_trend(std::span<const float> values, int degree, std::span<float> to) const {
  const std::vector<std::uint8_t> one(values.size(), 0);
  fill_rows(MeanPolynomial(region_moments(values, masked(one), 0, grid_), degree, grid_), to);
}

void PartitionPrice::fill_fields() {
  if (model_.shape == MeanShape::constant) return;
  for (std::size_t k = 0; k < fields_.size(); ++k)
    if (fields_[k].empty()) fill_field(k);
}

void PartitionPrice::fill_field(std::size_t k) {
  fields_[k].resize(values_.size());
  fill_rows(polynomials_[k], fields_[k]);
}

void PartitionPrice::fill_rows(const MeanPolynomial& polynomial, std::span<float> to) const {
  const Index nx = grid_.size[0];
  parallel_for(grid_.voxels() / nx, 64, [&](Index begin, Index end) {
    for (Index row = begin; row < end; ++row)
      polynomial.fill_row(row, to.subspan(static_cast<std::size_t>(row * nx), static_cast<std::size_t>(nx)));
  });
}

void PartitionPrice::drop_parts(std::span<const float> force, std::span<std::uint8_t> labels) const {
  csrbf::drop_parts(force, grid_, weight_, place_price(), labels);
}

double PartitionPrice::add_smooth_mean(std::span<const std::uint8_t> labels, std::size_t k) {
  std::vector<float>& field = fields_[k];
  std::vector<float> weight(field.size()), rest(field.size());
  for (std::size_t i = 0; i < field.size(); ++i) {
    const bool part = labels[i] == k && inside(i);
    weight[i] = part ? 1.0F : 0.0F;
    rest[i] = part ? static_cast<float>(value(i)) - field[i] : 0.0F;
  }
  const double parameters = smooth_mean(weight, rest, grid_, grain_, model_.reach);
  for (std::size_t i = 0; i < field.size(); ++i) field[i] += rest[i];
  return parameters;
}

double PartitionPrice::fit_background(std::span<const std::uint8_t> labels) {
  const LocalMean local_mean(grid_, model_.reach);
  fields_ = means_in_background(values_, labels, mask_, grid_, local_mean, means_);
  return local_mean.parameters;
}

// Each voxel has the mean of the nearest object. All objects are brighter than most voxels beside them or all are
// darker: one that is not has the mean of what surrounds it, or a border inside a region would give it two means.
double PartitionPrice::fit_objects(std::span<const std::uint8_t> labels, std::uint8_t k) {
  const VoxelComponents nearest = nearest_components(labels, k, grid_);
  const auto other = static_cast<std::size_t>(1 - k);
  std::vector<double> means(nearest.count, 0), around(nearest.count, 0), counts(nearest.count, 0);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] != k || !inside(i)) continue;
    means[nearest.component[i]] += value(i);
    around[nearest.component[i]] += mean(other, i);
    counts[nearest.component[i]] += 1;
  }
  for (std::size_t c = 0; c < means.size(); ++c) means[c] = counts[c] > 0 ? means[c] / counts[c] : means_[k];
  const std::vector<bool> differs =
      stand_out(nearest, values_, mask_, means, least_contrast * (means_[k] - means_[other]));
  for (std::size_t c = 0; c < means.size(); ++c)
    if (counts[c] > 0 && !differs[c]) means[c] = around[c] / counts[c];
  std::vector<float>& field = fields_[k];
  field.resize(labels.size());
  for (std::size_t i = 0; i < field.size(); ++i) field[i] = static_cast<float>(means[nearest.component[i]]);
  return static_cast<double>(nearest.count);
}

double PartitionPrice::residual(std::span<const std::uint8_t> labels, std::size_t k) const {
  return parallel_sum(std::ssize(labels), per_task, [&](Index begin, Index end) {
    double part = 0;
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      if (labels[i] == k && inside(i)) {
        const double off = value(i) - mean(k, i);
        part += certainty(i) * off * off;
      }
    return part;
  });
}

// From the sums of the squares that the means leave.
double PartitionPrice::fit_deviations(const std::vector<double>& squares) {
  double all = 0, price = 0;
  const double least = std::pow(least_deviation(), 2);
  variances_.assign(squares.size(), 0);
  for (std::size_t k = 0; k < squares.size(); ++k) {
    all += squares[k];
    variances_[k] = squares[k] / counts_[k] + least;
    price += 0.5 * counts_[k] * std::log(variances_[k]);
  }
  if (model_.own_deviations) return price;
  std::fill(variances_.begin(), variances_.end(), all / count_ + least);
  return 0.5 * count_ * std::log(variances_[0]);
}

// By the shares of bins; a constant of the Gaussian prices is left out.
double PartitionPrice::fit_shapes(std::span<const std::uint8_t> labels) {
  fill_fields();
  if (indices_.empty()) indices_ = bin_indices(values_, bins_);
  const bool own = model_.own_deviations;
  std::vector<std::uint8_t> bins = indices_, regions(labels.begin(), labels.end());
  for (std::size_t i = 0; i < bins.size() && !own; ++i) bins[i] = static_cast<std::uint8_t>(bin(labels[i], i));
  if (!own) std::fill(regions.begin(), regions.end(), std::uint8_t{0});
  const std::vector<Histogram> parts = region_histograms(bins, masked(regions), own ? std::ssize(means_) : 1, bins_);
  double price = -0.5 * count_ * (1 + std::log(2 * std::numbers::pi));
  tables_.clear();
  for (const Histogram& part : parts) {
    tables_.push_back(energy_table(fit_region_model(IntensityLaw::generalized_gaussian, part), bins_));
    price += total_energy(tables_.back(), part);
  }
  return price;
}

void PartitionPrice::mix_means(std::span<const float> share, std::span<float> to) {
  fill_fields();
  parallel_for(std::ssize(to), per_task, [&](Index begin, Index end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const double m0 = mean(0, i), m1 = mean(1, i);
      to[i] = static_cast<float>(m0 + (m1 - m0) * static_cast<double>(share[i]));
    }
  });
}

double PartitionPrice::mixed_deviation_price(std::span<const float> share, std::span<const float> residual) const {
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (!inside(i)) continue;
    const double off = certainty(i) * static_cast<double>(residual[i]) * static_cast<double>(residual[i]);
    squares += off;
    const double variance = variances_[0] + (variances_[1] - variances_[0]) * static_cast<double>(share[i]);
    if (model_.own_deviations) sum += 0.5 * (std::log(variance) + off / variance - 1);
  }
  if (model_.own_deviations) return sum / grain_;
  return 0.5 * count_ * std::log(squares / count_ + least_deviation() * least_deviation()) / grain_;
}

void PartitionPrice::cost(int k, std::span<float> to) {
  fill_fields();
  const auto region = static_cast<std::size_t>(k);
  const double factor = 0.5 / variances_[region] / grain_, level = 0.5 * std::log(variances_[region]) / grain_;
  parallel_for(std::ssize(to), per_task, [&](Index begin, Index end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const double off = value(i) - mean(region, i);
      to[i] = inside(i) ? static_cast<float>(factor * certainty(i) * off * off + level) : 0.0F;
      if (seeds_.labels.empty() || seeds_.labels[i] == 0) continue;
      const bool here = seeds_.labels[i] == k + 1;
      if (seeds_.is_certain(i))
        to[i] = here ? -certain_seed : certain_seed;
      else if (!here)
        to[i] += seeds_.at(i);
    }
  });
}

void PartitionPrice::force(std::span<float> to) {
  fill_fields();
  const double in = 0.5 / variances_[1] / grain_, out = 0.5 / variances_[0] / grain_;
  const double level = 0.5 * std::log(variances_[1] / variances_[0]) / grain_;
  const bool objects = model_.shape == MeanShape::objects;
  const double side = means_[1] - means_[0], away = model_.object_label == 1 ? 1 : -1;
  parallel_for(std::ssize(to), per_task, [&](Index begin, Index end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const double x = value(i), m1 = mean(1, i), m0 = mean(0, i);
      double F = model_.own_shapes
                     ? static_cast<double>(tables_.back()[bin(1, i)] - tables_.front()[bin(0, i)]) / grain_
                     : certainty(i) * (in * (x - m1) * (x - m1) - out * (x - m0) * (x - m0)) + level;
      // An object that is not brighter (darker) than its surroundings, as objects are, has no voxels.
      if (objects && (m1 - m0) * side <= least_contrast * side * side) F = away * (std::abs(F) + 1);
      to[i] = inside(i) ? static_cast<float>(F) : 0.0F;
      if (seeds_.labels.empty() || seeds_.labels[i] == 0) continue;
      const float cost = seeds_.labels[i] == 2 ? -seeds_.at(i) : seeds_.at(i);
      to[i] = seeds_.is_certain(i) ? cost : to[i] + cost;
    }
  });
}

std::vector<float> PartitionPrice::rest(std::span<const std::uint8_t> labels) {
  fill_fields();
  std::vector<float> result(labels.size(), 0.0F);
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (inside(i)) result[i] = static_cast<float>(value(i) - mean(labels[i], i));
  return result;
}

double PartitionPrice::correlation(std::span<const std::uint8_t> labels) {
  fill_fields();
  std::vector<double> products(means_.size(), 0), squares(means_.size(), 0), pairs(means_.size(), 0);
  const std::array<Index, 3> strides{1, grid_.size[0], grid_.size[0] * grid_.size[1]};
  const auto off = [&](std::size_t i) {
    return (value(i) - mean(labels[i], i)) * std::sqrt(certainty(i) / variances_[labels[i]]);
  };
  for (Index i = 0; i < grid_.voxels(); ++i) {
    const auto voxel = static_cast<std::size_t>(i);
    if (!inside(voxel)) continue;
    for (int a = 0; a < grid_.dimension(); ++a) {
      if (i / strides[a] % grid_.size[a] + 1 == grid_.size[a]) continue;
      const auto next = static_cast<std::size_t>(i + strides[a]);
      if (!inside(next) || labels[next] != labels[voxel]) continue;
      const double x = off(voxel), y = off(next);
      products[labels[voxel]] += x * y;
      squares[labels[voxel]] += 0.5 * (x * x + y * y);
      pairs[labels[voxel]] += 1;
    }
  }
  double most = 0;
  for (std::size_t k = 0; k < products.size(); ++k)
    if (squares[k] > 0) most = std::max(most, products[k] / std::max(squares[k], least_resolved * pairs[k]));
  return most;
}

double PartitionPrice::variation(std::span<const std::uint8_t> labels) {
  fill_fields();
  double most = 0;
  for (std::size_t k = 0; k < means_.size(); ++k) {
    if (model_.shape == MeanShape::objects && k != model_.object_label) continue;
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (labels[i] != k || !inside(i)) continue;
      sum += mean(k, i) - means_[k];
      squares += std::pow(mean(k, i) - means_[k], 2);
    }
    most = std::max(most, squares / counts_[k] - std::pow(sum / counts_[k], 2));
  }
  const double contrast = std::abs(means_[1] - means_[0]);
  return std::sqrt(most) / std::max(contrast, least_deviation());
}

}  // namespace csrbf
