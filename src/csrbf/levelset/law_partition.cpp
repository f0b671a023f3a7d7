#include "csrbf/levelset/law_partition.hpp"

#include "csrbf/levelset/partition/blurred_price.hpp"
#include "csrbf/levelset/segment_checks.hpp"

#include <utility>

namespace csrbf {

PartitionModel model_of_law(const SegmentSettings& used) {
  return {shape_of(used.shading).value_or(MeanShape::constant), used.energy != SegmentEnergy::chan_vese,
          used.energy == SegmentEnergy::generalized_gaussian};
}

std::vector<float> nearly_normal(std::span<const float> values, std::span<const std::uint8_t> mask,
                                 SegmentEnergy energy) {
  std::vector<float> result(values.begin(), values.end());
  if (energy != SegmentEnergy::gamma && energy != SegmentEnergy::rayleigh) return result;
  const double power = energy == SegmentEnergy::gamma ? 1.0 / 3 : 2.0 / 3;
  const double black = choose_bins(values, 256, mask).lo;
  for (float& value : result)
    value = static_cast<float>(std::pow(std::max(0.0, static_cast<double>(value) - black), power));
  return result;
}

bool loses_parts(PartitionPrice& price, MeanShape shape, std::span<const std::uint8_t> labels,
                 std::span<const std::uint8_t> classes) {
  constexpr double tolerance = 0.3;  // by hand: less takes structures of tissue for parts
  return fit_blurred(price, labels, {shape}).price >
         fit_blurred(price, classes, {shape}).price +
             tolerance * contour_price(labels, 1, price.grid().size, price.weight());
}

Partition better_by_law(PartitionPrice& price, const PartitionModel& model, Partition found, Partition means) {
  if (found.labels.empty()) return means;
  const PartitionModel gaussian{model.shape, true};
  const auto blurred = [&](const Partition& each) { return fit_blurred(price, each.labels, gaussian).price; };
  const double sharp = price.fit(found.labels, model), by_law = blurred(found), by_means = blurred(means);
  price.fit(found.labels, model);
  const bool follows_structures = price.correlation(found.labels) > independent && means.gain > 0;
  Partition& better = follows_structures || by_means < std::min(sharp, by_law) ? means : found;
  if (!follows_structures) better.model = std::min(by_means, by_law) < sharp ? gaussian : model;
  return std::move(better);
}

}  // namespace csrbf
