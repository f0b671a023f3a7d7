#include "csrbf/levelset/partition/partition_model.hpp"

#include "csrbf/core/parallel_sum.hpp"
#include "csrbf/levelset/image/box_mean.hpp"
#include "csrbf/levelset/partition/nearest_component.hpp"
#include "csrbf/levelset/regions/region_labels.hpp"

#include <Eigen/Cholesky>

#include <limits>
#include <numbers>

namespace csrbf {
namespace {

constexpr Index grain = 1 << 14;               // voxels per task
constexpr double least_deviation = 1.0 / 512;  // of the range: half a grey level of 256
constexpr double least_contrast = 0.1;  // of an object, of that of the regions; by hand: less is the surroundings
constexpr int most_terms = 10;          // of a quadratic in space

// 1, x, y, z, then the products, of coordinates in [-1, 1] along the axes that the image has.
class Monomials {
 public:
  Monomials(const Grid& grid, int degree) : grid_(grid), axes_(grid.dimension()) {
    terms = degree == 1 ? axes_ + 1 : (axes_ + 1) * (axes_ + 2) / 2;
  }
  int terms;
  void at(Index voxel, double* t) const {
    std::array<double, 3> p{};
    for (int a = 0; a < axes_; ++a) {
      const Index n = grid_.size[a];
      p[a] = n > 1 ? 2 * static_cast<double>(voxel % n) / static_cast<double>(n - 1) - 1 : 0;
      voxel /= n;
    }
    products(p, t);
  }
  /// Sum of c_j t_j where x is given and y and z are those of the voxel.
  [[nodiscard]] double sum(const double* c, Index voxel, double x) const {
    std::array<double, most_terms> t{};
    std::array<double, 3> p{x, 0, 0};
    voxel /= grid_.size[0];
    for (int a = 1; a < axes_; ++a) {
      const Index n = grid_.size[a];
      p[a] = n > 1 ? 2 * static_cast<double>(voxel % n) / static_cast<double>(n - 1) - 1 : 0;
      voxel /= n;
    }
    products(p, t.data());
    double total = 0;
    for (int j = 0; j < terms; ++j) total += c[j] * t[j];
    return total;
  }

 private:
  void products(const std::array<double, 3>& p, double* t) const {
    int term = 0;
    t[term++] = 1;
    for (int a = 0; a < axes_; ++a) t[term++] = p[a];
    if (terms == axes_ + 1) return;
    for (int a = 0; a < axes_; ++a)
      for (int b = a; b < axes_; ++b) t[term++] = p[a] * p[b];
  }

  const Grid& grid_;
  int axes_;
};

}  // namespace

PartitionPrice::PartitionPrice(std::span<const float> values, double lo, double hi, const Grid& grid,
                               std::span<const std::uint8_t> mask, const ContourWeight& weight)
    : values_(values), lo_(lo), inverse_(1 / (hi - lo)), grid_(grid), mask_(mask), weight_(weight) {
  for (std::size_t i = 0; i < values.size(); ++i) count_ += inside(i) ? 1 : 0;
}

double PartitionPrice::fit_values(std::span<const std::uint8_t> labels, const PartitionModel& model, int regions) {
  const auto n = static_cast<std::size_t>(regions);
  model_ = model;
  means_.assign(n, 0);
  counts_.assign(n, 0);
  variances_.assign(n, 0);
  fields_.assign(n, {});
  fit_constants(labels);
  for (const double count : counts_)
    if (count < 3) return std::numeric_limits<double>::infinity();
  double parameters = static_cast<double>(n);
  if (model.shape == MeanShape::objects) {
    const auto other = static_cast<std::size_t>(1 - model.object_label);
    parameters = fit_polynomial(labels, other, 2) + fit_objects(labels, model.object_label);
  } else if (model.shape != MeanShape::constant) {
    parameters = 0;
    for (std::size_t k = 0; k < n; ++k) {
      parameters += fit_polynomial(labels, k, model.shape == MeanShape::linear ? 1 : 2);
      if (model.shape == MeanShape::smooth) parameters += add_local_mean(labels, k);
    }
  }
  parameters += model.own_deviations ? static_cast<double>(n) : 1;
  return fit_deviations(labels, model.own_deviations) + 0.5 * parameters * std::log(count_);
}

double PartitionPrice::label_price(std::span<const std::uint8_t> labels, int regions) const {
  if (regions == 2)
    return contour_price(labels, 1, grid_.size, weight_) + place_price() * static_cast<double>(count_parts(labels));
  double price = 0;
  // A contour between two regions is the border of both.
  for (int k = 0; k < regions; ++k)
    price += 0.5 * contour_price(labels, static_cast<std::uint8_t>(k), grid_.size, weight_);
  return price;
}

Index PartitionPrice::count_parts(std::span<const std::uint8_t> labels) const {
  std::vector<std::uint8_t> others(labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) others[i] = labels[i] == 0 ? 1 : 0;
  return count_components(labels, grid_) + count_components(others, grid_);
}

void PartitionPrice::drop_parts(std::span<const float> force, std::span<std::uint8_t> labels) const {
  const std::array<Index, 3> strides{1, grid_.size[0], grid_.size[0] * grid_.size[1]};
  for (const std::uint8_t label : {std::uint8_t{1}, std::uint8_t{0}}) {
    const NearestComponents parts = nearest_components(labels, label, grid_);
    std::vector<double> gain(parts.count, 0);  // of the part being there
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (labels[i] == label) gain[parts.component[i]] += (label == 1 ? -1 : 1) * static_cast<double>(force[i]);
    // The contour, as in contour_price(), of the part of the voxel inside it or next to it.
    for (Index i = 0; i < std::ssize(labels); ++i) {
      double squares = 0;
      std::int32_t part = labels[i] == label ? parts.component[i] : -1;
      for (std::size_t a = 0; a < 3; ++a) {
        if (i / strides[a] % grid_.size[a] + 1 == grid_.size[a]) continue;
        const Index next = i + strides[a];
        if (labels[next] == labels[i]) continue;
        squares += weight_.along[a] * weight_.along[a];
        if (part < 0) part = parts.component[next];
      }
      if (squares > 0) gain[part] -= weight_.length * std::sqrt(squares);
    }
    if (parts.count < 2) continue;
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (labels[i] == label && gain[parts.component[i]] < place_price()) labels[i] = 1 - label;
  }
}

void PartitionPrice::fit_constants(std::span<const std::uint8_t> labels) {
  for (std::size_t k = 0; k < means_.size(); ++k) {
    const auto sum = [&](bool of_values) {
      return parallel_sum(std::ssize(labels), grain, [&](Index begin, Index end) {
        double part = 0;
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
          if (labels[i] == k && inside(i)) part += of_values ? value(i) : 1;
        return part;
      });
    };
    counts_[k] = sum(false);
    means_[k] = counts_[k] > 0 ? sum(true) / counts_[k] : 0;
  }
}

double PartitionPrice::fit_polynomial(std::span<const std::uint8_t> labels, std::size_t k, int degree) {
  constexpr Index enough = 1 << 18;  // voxels sampled: far more than there are numbers to fit
  const Monomials monomials(grid_, degree);
  using Left = Eigen::Matrix<double, most_terms, most_terms>;
  using Right = Eigen::Matrix<double, most_terms, 1>;
  const Index n = grid_.voxels(), step = std::max<Index>(1, n / enough) | 1;
  const Index samples = (n + step - 1) / step, tasks = (samples + grain - 1) / grain;
  std::vector<Left> lefts(tasks, Left::Zero());
  std::vector<Right> rights(tasks, Right::Zero());
  parallel_for(samples, grain, [&](Index begin, Index end) {
    Right t = Right::Zero();
    for (Index s = begin; s < end; ++s) {
      const Index i = s * step;
      const auto voxel = static_cast<std::size_t>(i);
      if (labels[voxel] != k || !inside(voxel)) continue;
      monomials.at(i, t.data());
      lefts[begin / grain].noalias() += t * t.transpose();
      rights[begin / grain] += (value(voxel) - means_[k]) * t;
    }
  });
  Left left = Left::Zero();
  Right right = Right::Zero();
  for (Index task = 0; task < tasks; ++task) {
    left += lefts[task];
    right += rights[task];
  }
  constexpr double ridge = 1e-6;  // of the voxels, for regions within a row
  left.diagonal().array() += ridge * (left(0, 0) + 1);
  Right c = left.ldlt().solve(right);
  c[0] += means_[k];
  std::vector<float>& field = fields_[k];
  field.resize(labels.size());
  const Index nx = grid_.size[0];
  parallel_for(n / nx, 64, [&](Index begin, Index end) {
    for (Index row = begin; row < end; ++row) {
      // Along x a parabola, from its values at -1, 0 and 1.
      const double left_end = monomials.sum(c.data(), row * nx, -1), middle = monomials.sum(c.data(), row * nx, 0),
                   right_end = monomials.sum(c.data(), row * nx, 1);
      const double slope = 0.5 * (right_end - left_end), bend = 0.5 * (right_end + left_end) - middle;
      for (Index x = 0; x < nx; ++x) {
        const double p = nx > 1 ? 2 * static_cast<double>(x) / static_cast<double>(nx - 1) - 1 : 0;
        field[row * nx + x] = static_cast<float>(middle + p * (slope + p * bend));
      }
    }
  });
  return monomials.terms;
}

// The mean of the residuals close by, drawn to 0 where there are none.
double PartitionPrice::add_local_mean(std::span<const std::uint8_t> labels, std::size_t k) {
  constexpr double reach = 0.125;  // standard deviation of the weights, of the longest side: a few numbers per axis
  constexpr float prior = 0.02F;   // weight of 0, of that of a full neighbourhood; by hand
  std::array<Index, 3> half{0, 0, 0};
  double longest = 0, parameters = 1;
  for (int a = 0; a < 3; ++a) longest = std::max(longest, static_cast<double>(grid_.size[a]) * grid_.spacing[a]);
  for (int a = 0; a < grid_.dimension(); ++a) {
    half[a] = std::clamp<Index>(std::lround(reach * longest / grid_.spacing[a]), 1, grid_.size[a]);
    const double area = 2 * std::sqrt(std::numbers::pi) * static_cast<double>(half[a]);
    parameters *= std::max(1.0, static_cast<double>(grid_.size[a]) / area);
  }
  std::vector<float>& field = fields_[k];
  std::vector<float> weight(field.size()), sum(field.size());
  for (std::size_t i = 0; i < field.size(); ++i) {
    const bool part = labels[i] == k && inside(i);
    weight[i] = part ? 1.0F : 0.0F;
    sum[i] = part ? static_cast<float>(value(i)) - field[i] : 0.0F;
  }
  // Three boxes have about the profile, and the standard deviation, of a Gaussian of their half width.
  for (int pass = 0; pass < 3; ++pass) {
    box_mean(weight, grid_.size, half);
    box_mean(sum, grid_.size, half);
  }
  for (std::size_t i = 0; i < field.size(); ++i) field[i] += sum[i] / (weight[i] + prior);
  return parameters;
}

// Each voxel has the mean of the nearest object. All objects are brighter than their surroundings or all are darker: an
// object that is not has the mean of what surrounds it.
double PartitionPrice::fit_objects(std::span<const std::uint8_t> labels, std::uint8_t k) {
  const NearestComponents nearest = nearest_components(labels, k, grid_);
  const auto other = static_cast<std::size_t>(1 - k);
  const double side = means_[k] - means_[other];
  std::vector<double> sums(nearest.count, 0), around(nearest.count, 0), counts(nearest.count, 0);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] != k || !inside(i)) continue;
    sums[nearest.component[i]] += value(i);
    around[nearest.component[i]] += mean(other, i);
    counts[nearest.component[i]] += 1;
  }
  for (std::size_t c = 0; c < sums.size(); ++c) {
    const bool differs = (sums[c] - around[c]) * side > least_contrast * side * side * counts[c];
    sums[c] = counts[c] > 0 ? (differs ? sums[c] : around[c]) / counts[c] : means_[k];
  }
  std::vector<float>& field = fields_[k];
  field.resize(labels.size());
  for (std::size_t i = 0; i < field.size(); ++i) field[i] = static_cast<float>(sums[nearest.component[i]]);
  return static_cast<double>(nearest.count);
}

double PartitionPrice::fit_deviations(std::span<const std::uint8_t> labels, bool own) {
  double all = 0, price = 0;
  constexpr double least = least_deviation * least_deviation;
  for (std::size_t k = 0; k < means_.size(); ++k) {
    const double squares = parallel_sum(std::ssize(labels), grain, [&](Index begin, Index end) {
      double part = 0;
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
        if (labels[i] == k && inside(i)) {
          const double off = value(i) - mean(k, i);
          part += off * off;
        }
      return part;
    });
    all += squares;
    variances_[k] = squares / counts_[k] + least;
    price += 0.5 * counts_[k] * std::log(variances_[k]);
  }
  if (own) return price;
  std::fill(variances_.begin(), variances_.end(), all / count_ + least);
  return 0.5 * count_ * std::log(variances_[0]);
}

void PartitionPrice::cost(int k, std::span<float> to) const {
  const auto region = static_cast<std::size_t>(k);
  const double factor = 0.5 / variances_[region], level = 0.5 * std::log(variances_[region]);
  parallel_for(std::ssize(to), grain, [&](Index begin, Index end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const double off = value(i) - mean(region, i);
      to[i] = inside(i) ? static_cast<float>(factor * off * off + level) : 0.0F;
    }
  });
}

void PartitionPrice::force(std::span<float> to) const {
  const double in = 0.5 / variances_[1], out = 0.5 / variances_[0];
  const double level = 0.5 * std::log(variances_[1] / variances_[0]);
  const bool objects = model_.shape == MeanShape::objects;
  const double side = means_[1] - means_[0], away = model_.object_label == 1 ? 1 : -1;
  parallel_for(std::ssize(to), grain, [&](Index begin, Index end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const double x = value(i), m1 = mean(1, i), m0 = mean(0, i);
      double F = in * (x - m1) * (x - m1) - out * (x - m0) * (x - m0) + level;
      // An object that is not brighter (darker) than its surroundings, as objects are, has no voxels.
      if (objects && (m1 - m0) * side <= least_contrast * side * side) F = away * (std::abs(F) + 1);
      to[i] = inside(i) ? static_cast<float>(F) : 0.0F;
    }
  });
}

double PartitionPrice::correlation(std::span<const std::uint8_t> labels) const {
  std::vector<double> products(means_.size(), 0), squares(means_.size(), 0);
  const Index n = grid_.voxels();
  const std::array<Index, 3> strides{1, grid_.size[0], grid_.size[0] * grid_.size[1]};
  const auto off = [&](std::size_t i) { return (value(i) - mean(labels[i], i)) / std::sqrt(variances_[labels[i]]); };
  for (Index i = 0; i < n; ++i) {
    const auto voxel = static_cast<std::size_t>(i);
    if (!inside(voxel)) continue;
    for (int a = 0; a < grid_.dimension(); ++a) {
      if (i / strides[a] % grid_.size[a] + 1 == grid_.size[a]) continue;
      const auto next = static_cast<std::size_t>(i + strides[a]);
      if (!inside(next) || labels[next] != labels[voxel]) continue;
      const double x = off(voxel), y = off(next);
      products[labels[voxel]] += x * y;
      squares[labels[voxel]] += 0.5 * (x * x + y * y);
    }
  }
  double most = 0;
  for (std::size_t k = 0; k < products.size(); ++k)
    if (squares[k] > 0) most = std::max(most, products[k] / squares[k]);
  return most;
}

double PartitionPrice::variation(std::span<const std::uint8_t> labels) const {
  double most = 0;
  for (std::size_t k = 0; k < means_.size(); ++k) {
    if (model_.shape == MeanShape::objects && k != model_.object_label) continue;
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (labels[i] != k || !inside(i)) continue;
      const double off = mean(k, i) - means_[k];
      sum += off;
      squares += off * off;
    }
    most = std::max(most, squares / counts_[k] - std::pow(sum / counts_[k], 2));
  }
  const double contrast = std::abs(means_[1] - means_[0]);
  return std::sqrt(most) / std::max(contrast, least_deviation);
}

}  // namespace csrbf
