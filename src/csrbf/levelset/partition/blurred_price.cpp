#include "csrbf/levelset/partition/blurred_price.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/levelset/image/box_mean.hpp"
#include "csrbf/levelset/image/gaussian_blur.hpp"

#include <limits>

namespace csrbf {
namespace {

constexpr std::array<double, 4> blurs{0, 0.7, 1.4, 2.8};  // by hand: finer steps choose the same labels

std::vector<float> shares(std::span<const std::uint8_t> labels, const PartitionPrice& price, double blur) {
  std::vector<float> share(labels.size());
  for (std::size_t i = 0; i < share.size(); ++i) share[i] = labels[i] != 0 ? 1.0F : 0.0F;
  if (blur == 0) return share;
  std::array<double, 3> along{0, 0, 0};
  for (std::size_t a = 0; a < 3; ++a) along[a] = blur * price.weight().along[a];
  gaussian_blur(share, price.grid().size, along);
  return share;
}

// By the last fit() of the model.
double blur_means(PartitionPrice& price, std::span<const std::uint8_t> labels, double blur,
                  std::vector<float>& residual) {
  const std::span<const float> values = price.values();
  const std::vector<float> share = shares(labels, price, blur);
  std::vector<float> mean(values.size());
  residual.assign(values.size(), 0.0F);
  price.mix_means(share, mean);
  // Blurred regions are farther apart than the means of their voxels say.
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    if (!price.inside(i)) continue;
    const auto x = static_cast<double>(mean[i]), y = static_cast<double>(values[i]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const double count = price.voxels(), spread = sxx - sx * sx / count;
  const double slope = spread > 1e-12 * count ? (sxy - sx * sy / count) / spread : 0;
  const double level = (sy - slope * sx) / count;
  for (std::size_t i = 0; i < mean.size(); ++i)
    if (price.inside(i))
      residual[i] = static_cast<float>(static_cast<double>(values[i]) - level - slope * static_cast<double>(mean[i]));
  return price.mixed_deviation_price(share, residual);
}

}  // namespace

double residual_correlation(std::span<const float> residual, const Grid& grid) {
  double squares = 0, most = 0;
  for (const float each : residual) squares += static_cast<double>(each) * static_cast<double>(each);
  Index stride = 1;
  for (int a = 0; a < grid.dimension(); ++a) {
    double products = 0;
    for (Index i = 0; i + stride < grid.voxels(); ++i)
      if (i / stride % grid.size[a] + 1 < grid.size[a])
        products += static_cast<double>(residual[i]) * static_cast<double>(residual[i + stride]);
    most = std::max(most, products / std::max(squares, 1e-30));
    stride *= grid.size[a];
  }
  return most;
}

BlurredFit fit_blurred(PartitionPrice& price, std::span<const std::uint8_t> labels, const PartitionModel& model) {
  BlurredFit best{std::numeric_limits<double>::infinity(), 0, {}};
  const double sharp = price.fit(labels, model);
  if (!std::isfinite(sharp)) return best;
  if (model.own_shapes) return {sharp, 0, price.rest(labels)};  // mixtures of shapes are none
  const double others = sharp - price.deviation_price();
  for (const double blur : blurs) {
    std::vector<float> residual;
    const double nats = others + blur_means(price, labels, blur, residual);
    if (nats >= best.price) continue;
    best = {nats, blur, std::move(residual)};
  }
  return best;
}

double blurred_likelihood(PartitionPrice& price, std::span<const std::uint8_t> labels, const PartitionModel& model,
                          double blur) {
  const double sharp = price.fit(labels, model);
  if (!std::isfinite(sharp)) return sharp;
  if (model.own_shapes) return price.deviation_price();
  std::vector<float> residual;
  return blur_means(price, labels, blur, residual);
}

bool place_blurred_contour(PartitionPrice& price, const PartitionModel& model, std::vector<std::uint8_t>& labels) {
  constexpr Index reach = 2;                                    // voxels that it moves at most
  constexpr std::array<double, 5> widths{0.5, 0.7, 1, 1.4, 2};  // of the Gaussians, in voxels
  PartitionModel blurred = model;
  blurred.own_shapes = false;
  BlurredFit best = fit_blurred(price, labels, blurred);
  const Grid& grid = price.grid();
  if (!(best.blur > 0) || residual_correlation(best.residual, grid) > independent) return false;
  const std::size_t voxels = labels.size();
  std::array<Index, 3> half{reach, reach, reach};
  for (std::size_t a = 0; a < 3; ++a) half[a] = grid.size[a] > 1 ? reach : 0;
  std::vector<float> near = shares(labels, price, 0);
  box_mean(near, grid.size, half);
  std::array<std::vector<float>, 2> means{std::vector<float>(voxels), std::vector<float>(voxels)};
  price.fit(labels, blurred);
  price.mix_means(std::vector<float>(voxels, 0.0F), means[0]);
  price.mix_means(std::vector<float>(voxels, 1.0F), means[1]);
  const std::vector<std::uint8_t> found = labels;
  for (const double width : widths) {
    // What is outside the mask does not count.
    std::vector<float> value(price.values().begin(), price.values().end()), weight(voxels);
    for (std::size_t i = 0; i < voxels; ++i) weight[i] = price.inside(i) ? 1.0F : 0.0F;
    std::array<double, 3> along{0, 0, 0};
    for (std::size_t a = 0; a < 3; ++a) along[a] = width * price.weight().along[a];
    gaussian_blur(value, grid.size, along);
    gaussian_blur(weight, grid.size, along);
    std::vector<std::uint8_t> moved = found;
    for (std::size_t i = 0; i < voxels; ++i) {
      if (!(near[i] > 0 && near[i] < 1) || !price.inside(i)) continue;
      const float above = value[i] / weight[i] - 0.5F * (means[0][i] + means[1][i]);
      moved[i] = (above > 0) == (means[1][i] > means[0][i]) ? 1 : 0;
    }
    const double nats = fit_blurred(price, moved, blurred).price;
    if (nats >= best.price) continue;
    best.price = nats;
    labels = std::move(moved);
  }
  return labels != found;
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
