#include "csrbf/levelset/partition/blurred_price.hpp"

#include "csrbf/core/percentile.hpp"
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

}  // namespace

BlurredFit fit_blurred(PartitionPrice& price, std::span<const std::uint8_t> labels, const PartitionModel& model) {
  BlurredFit best{std::numeric_limits<double>::infinity(), 0, {}};
  const double sharp = price.fit(labels, model);
  if (!std::isfinite(sharp)) return best;
  if (model.own_shapes) return {sharp, 0, price.rest(labels)};  // mixtures of shapes are none
  const double others = sharp - price.deviation_price();
  const std::span<const float> values = price.values();
  for (const double blur : blurs) {
    const std::vector<float> share = shares(labels, price, blur);
    std::vector<float> mean(values.size()), residual(values.size(), 0.0F);
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
    const double nats = others + price.mixed_deviation_price(share, residual);
    if (nats >= best.price) continue;
    best = {nats, blur, std::move(residual)};
  }
  return best;
}

bool are_clear(PartitionPrice& price, std::span<const std::uint8_t> labels, const PartitionModel& model) {
  constexpr double clearly = 0.2;  // of the contrast; halves of normal noise leave 0.43 of theirs, its peaks some 0.3
  std::vector<double> off;
  const std::vector<float> residual = fit_blurred(price, labels, model).residual;
  for (std::size_t i = 0; i < residual.size(); ++i)
    if (price.inside(i)) off.push_back(std::abs(static_cast<double>(residual[i])));
  return median(off) < clearly * median_of_normal * std::abs(price.means()[1] - price.means()[0]);
}

}  // namespace csrbf
