#include "csrbf/levelset/partition/blurred_price.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/levelset/image/box_mean.hpp"
#include "csrbf/levelset/image/gaussian_blur.hpp"

#include <limits>
#include <numbers>

namespace csrbf {
namespace {

std::vector<float> shares(std::span<const std::uint8_t> labels, const PartitionPrice& price, double blur) {
  std::vector<float> share(labels.size());
  for (std::size_t i = 0; i < share.size(); ++i) share[i] = labels[i] != 0 ? 1.0F : 0.0F;
  if (blur == 0) return share;
  std::array<double, 3> along{0, 0, 0};
  for (std::size_t a = 0; a < 3; ++a) along[a] = blur * price.weight().along[a];
  gaussian_blur(share, price.grid().size, along);
  return share;
}

// A straight line, by least squares.
struct Line {
  double level = 0, slope = 0;
};

Line line_of(const PartitionPrice& price, std::span<const float> along, std::span<const float> values) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < along.size(); ++i) {
    if (!price.inside(i)) continue;
    const auto x = static_cast<double>(along[i]), y = static_cast<double>(values[i]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const double count = price.voxels(), spread = sxx - sx * sx / count;
  const double slope = spread > 1e-12 * count ? (sxy - sx * sy / count) / spread : 0;
  return {(sy - slope * sx) / count, slope};
}

struct BlurredMeans {
  double price = 0;  // of the voxels
  std::vector<float> residual;
};

// By the last fit() of the model.
BlurredMeans blur_means(PartitionPrice& price, std::span<const std::uint8_t> labels, double blur) {
  const std::span<const float> values = price.values();
  const std::vector<float> share = shares(labels, price, blur);
  std::vector<float> mean(values.size()), residual(values.size(), 0.0F);
  price.mix_means(share, mean);
  // Blurred regions are farther apart than the means of their voxels say.
  const Line line = line_of(price, mean, values);
  for (std::size_t i = 0; i < mean.size(); ++i)
    if (price.inside(i))
      residual[i] =
          static_cast<float>(static_cast<double>(values[i]) - line.level - line.slope * static_cast<double>(mean[i]));
  return {price.mixed_deviation_price(share, residual), std::move(residual)};
}

// How far the middle between the means before the blur is above that between the means of the voxels, by the last
// fit(). The regions are farther apart, light is the same.
double middle_shift(PartitionPrice& price, std::span<const std::uint8_t> labels, double blur) {
  std::vector<float> mean(labels.size()), light(labels.size()), rest(price.values().begin(), price.values().end());
  price.mix_means(shares(labels, price, blur), mean);
  price.mix_means(shares(labels, price, 0), light);
  for (std::size_t i = 0; i < light.size(); ++i) {
    light[i] -= static_cast<float>(price.means()[labels[i] != 0 ? 1 : 0]);
    mean[i] -= light[i];
    rest[i] -= light[i];
  }
  const Line line = line_of(price, mean, rest);
  return line.level + (line.slope - 1) * 0.5 * (price.means()[0] + price.means()[1]);
}

// The middle between the means of both regions, and what the mean of region 1 has above it, by the last fit().
struct Middle {
  std::vector<float> value, half;
};

Middle middle_of_means(PartitionPrice& price) {
  const std::size_t voxels = price.values().size();
  Middle middle{std::vector<float>(voxels), std::vector<float>(voxels)};
  price.mix_means(std::vector<float>(voxels, 0.5F), middle.value);
  price.mix_means(std::vector<float>(voxels, 1.0F), middle.half);
  for (std::size_t i = 0; i < voxels; ++i) middle.half[i] -= middle.value[i];
  return middle;
}

double squares(std::span<const float> residual) {
  double sum = 0;
  for (const float each : residual) sum += static_cast<double>(each) * static_cast<double>(each);
  return sum;
}

struct Neighbors {
  double products = 0, pairs = 0;
};

// What next voxels along an axis have in common, of the pairs of which both count.
template <class Counts>
Neighbors neighbors_along(std::span<const float> residual, const Grid& grid, int axis, const Counts& counts) {
  Neighbors found;
  Index stride = 1;
  for (int a = 0; a < axis; ++a) stride *= grid.size[a];
  for (Index k = 0; k + stride < grid.voxels(); ++k) {
    const auto i = static_cast<std::size_t>(k), next = static_cast<std::size_t>(k + stride);
    if (k / stride % grid.size[axis] + 1 == grid.size[axis] || !counts(i) || !counts(next)) continue;
    found.products += static_cast<double>(residual[i]) * static_cast<double>(residual[next]);
    found.pairs += 1;
  }
  return found;
}

// Voxels with both labels within two voxels.
std::vector<std::uint8_t> close_to_contour(std::span<const std::uint8_t> labels, const PartitionPrice& price) {
  constexpr Index reach = 2;
  const Grid& grid = price.grid();
  std::array<Index, 3> half{reach, reach, reach};
  for (std::size_t a = 0; a < 3; ++a) half[a] = grid.size[a] > 1 ? reach : 0;
  std::vector<float> share = shares(labels, price, 0);
  box_mean(share, grid.size, half);
  std::vector<std::uint8_t> close(labels.size());
  for (std::size_t i = 0; i < close.size(); ++i) close[i] = share[i] > 0 && share[i] < 1 && price.inside(i) ? 1 : 0;
  return close;
}

// What a voxel has above the middle between the means before the blur, or above a level that is so far from it as a
// share of the half of their difference, by the last fit(); below, where region 1 is darker.
std::vector<float> off_middle(const PartitionPrice& price, const Middle& middle, double shift, double level) {
  std::vector<float> off(price.values().size(), 0.0F);
  for (std::size_t i = 0; i < off.size(); ++i) {
    if (!price.inside(i)) continue;
    const float half = middle.half[i], above = price.values()[i] - middle.value[i] - static_cast<float>(shift);
    off[i] = std::copysign(1.0F, half) * above - static_cast<float>(level) * std::abs(half);
  }
  return off;
}

// Gives voxels close to the contour the label of the region that their mean over a Gaussian is closer to.
void move_to_middle(std::vector<float> off, double width, std::span<const std::uint8_t> close,
                    const PartitionPrice& price, std::span<std::uint8_t> labels) {
  // What is outside the mask is 0 and does not count.
  if (width > 0) {
    std::array<double, 3> along{0, 0, 0};
    for (std::size_t a = 0; a < 3; ++a) along[a] = width * price.weight().along[a];
    gaussian_blur(off, price.grid().size, along);
  }
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (close[i] != 0) labels[i] = off[i] > 0 ? 1 : 0;
}

BlurredFit fit_blurs(PartitionPrice& price, std::span<const std::uint8_t> labels, const PartitionModel& model,
                     const std::vector<double>& blurs) {
  BlurredFit best;
  best.price = std::numeric_limits<double>::infinity();
  const double sharp = price.fit(labels, model);
  if (!std::isfinite(sharp)) return best;
  if (model.own_shapes) return {sharp, 0, price.rest(labels)};  // mixtures of shapes are none
  const double others = sharp - price.deviation_price();
  for (const double blur : blurs) {
    BlurredMeans means = blur_means(price, labels, blur);
    if (others + means.price >= best.price) continue;
    best = {others + means.price, blur, std::move(means.residual)};
  }
  return best;
}

}  // namespace

double residual_correlation(std::span<const float> residual, const Grid& grid) {
  const double all = squares(residual);
  double most = 0;
  for (int a = 0; a < grid.dimension(); ++a) {
    const Neighbors along = neighbors_along(residual, grid, a, [](std::size_t) { return true; });
    most = std::max(most, along.products / std::max(all, 1e-30));
  }
  return most;
}

BlurredFit fit_blurred(PartitionPrice& price, std::span<const std::uint8_t> labels, const PartitionModel& model) {
  return fit_blurs(price, labels, model, {0, 0.7, 1.4, 2.8});  // by hand: finer steps choose the same labels
}

double blurred_likelihood(PartitionPrice& price, std::span<const std::uint8_t> labels, const PartitionModel& model,
                          double blur) {
  const double sharp = price.fit(labels, model);
  if (!std::isfinite(sharp)) return sharp;
  if (model.own_shapes) return price.deviation_price();
  return blur_means(price, labels, blur).price;
}

double structures_left(PartitionPrice& price, std::span<const std::uint8_t> labels, const PartitionModel& model) {
  const std::vector<float> residual = fit_blurred(price, labels, model).residual;
  if (residual.empty()) return 0;  // no model of the labels has a price
  const std::vector<std::uint8_t> close = close_to_contour(labels, price);
  double most = 0;
  for (int a = 0; a < price.grid().dimension(); ++a) {
    const Neighbors along =
        neighbors_along(residual, price.grid(), a, [&](std::size_t i) { return close[i] == 0 && price.inside(i); });
    most = std::max(most, along.products / std::max(along.pairs, 1.0));
  }
  return most;
}

bool place_blurred_contour(PartitionPrice& price, const PartitionModel& model, std::vector<std::uint8_t>& labels) {
  constexpr int rounds = 8;           // of means and contours; by hand: most end after 2 to 4
  constexpr double least_gain = 0.5;  // nats: less is not worth a round
  // Of the squares that were left, when they are correlated; by hand: structures within regions keep at least 0.83,
  // a contour that was off leaves at most 0.75.
  constexpr double structure = 0.8;
  constexpr double finer = std::numbers::sqrt2;
  constexpr double usual = 0.7;  // width to go on with where no width is better at once; by hand
  constexpr double step = 0.3;   // of levels beside the middle, which thin objects may not pass; by hand
  std::vector<double> widths{0, 0.5, 0.7, 1, 1.4, 2};  // of the Gaussians, in voxels; after the first round one of them
  PartitionModel blurred = model;
  blurred.own_shapes = false;
  BlurredFit best = fit_blurred(price, labels, blurred);
  if (!(best.blur > 0)) return false;
  best = fit_blurs(price, labels, blurred, {best.blur / finer, best.blur, best.blur * finer});
  const bool is_noise = residual_correlation(best.residual, price.grid()) <= independent;
  const double left = squares(best.residual);
  const std::vector<std::uint8_t> close = close_to_contour(labels, price), found = labels;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<double> blurs{best.blur / finer, best.blur, best.blur * finer};
    price.fit(labels, blurred);
    const Middle middle = middle_of_means(price);
    // Means that vary in space hold what the blur mixes into them.
    const bool is_even = model.shape == MeanShape::constant || model.shape == MeanShape::objects;
    const double shift = is_even ? middle_shift(price, labels, best.blur) : 0;
    std::vector<std::uint8_t> next;
    for (const double level : round == 0 ? std::vector<double>{0} : std::vector<double>{-step, 0, step})
      for (const double width : std::vector<double>(widths)) {
        std::vector<std::uint8_t> moved = found;
        move_to_middle(off_middle(price, middle, shift, level), width, close, price, moved);
        BlurredFit now = fit_blurs(price, moved, blurred, blurs);
        if (!(now.price < best.price - least_gain)) continue;
        best = std::move(now);
        next = std::move(moved);
        widths = {width};
      }
    if (next.empty() && round > 0) break;
    if (next.empty()) widths = {usual};
    if (!next.empty()) labels = std::move(next);
  }
  if (is_noise || squares(best.residual) < structure * left) return labels != found;
  labels = found;
  return false;
}

bool are_clear(PartitionPrice& price, std::span<const std::uint8_t> labels, const PartitionModel& model) {
  constexpr double clearly = 0.2;  // of the contrast; halves of normal noise leave 0.43 of theirs, its peaks some 0.3
  std::vector<double> off;
  const std::vector<float> residual = fit_blurred(price, labels, model).residual;
  for (std::size_t i = 0; i < residual.size(); ++i)
    if (price.inside(i)) off.push_back(std::abs(static_cast<double>(residual[i])));
  if (off.empty()) return false;  // no model of the labels has a price
  return median(off) < clearly * median_of_normal * std::abs(price.means()[1] - price.means()[0]);
}

}  // namespace csrbf
