#include "csrbf/levelset/disturbances/calm_partition.hpp"

#include "csrbf/levelset/disturbances/fringes.hpp"
#include "csrbf/levelset/disturbances/uneven_noise.hpp"
#include "csrbf/levelset/image/noise_law.hpp"
#include "csrbf/levelset/partition/blurred_price.hpp"
#include "csrbf/levelset/regions/intensity_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace csrbf {
namespace {

bool leave_out_fringes(std::span<const float> values, Partition& found, std::optional<PartitionPrice>& price,
                       const PartitionSearch& search, Disturbances& to) {
  const Grid& grid = price->grid();
  std::optional<Fringes> fringes = find_fringes(values, grid, price->mask());
  if (!fringes) return false;
  PartitionPrice other = search.price(fringes->values);
  const ContourWeight weight = other.weight();
  Partition again = search.find(other, {}, {});
  if (again.labels.empty() || !(again.gain > 0)) return false;
  // In one range of values, and of single voxels.
  const IntensityBins bins = choose_bins(values, 256, price->mask());
  const auto nats = [&](std::span<const float> of, const Partition& by) {
    PartitionPrice same(of, bins.lo, bins.hi, grid, price->mask(), weight, bins.count);
    return fit_blurred(same, by.labels, by.model).price;
  };
  constexpr double numbers = 4;  // of a wave
  const double waves = 0.5 * numbers * std::log(price->voxels()) * static_cast<double>(fringes->waves);
  if (nats(fringes->values, again) + waves > nats(values, found)) return false;
  found = std::move(again);
  price.emplace(std::move(other));
  to.waves = fringes->waves;
  to.values = std::move(fringes->values);
  return true;
}

bool follow_uneven_noise(std::span<const float> values, Partition& found, std::optional<PartitionPrice>& price,
                         const PartitionSearch& search, Disturbances& to) {
  std::optional<UnevenNoise> noise = find_uneven_noise(*price);
  if (!noise) return false;
  PartitionPrice other = search.price(values);
  other.set_certainty(std::move(noise->certainty));
  Partition again = search.find(other, {}, {});
  const auto nats = [](PartitionPrice& of, const Partition& by) {
    return of.grain() * fit_blurred(of, by.labels, by.model).price;
  };
  if (again.labels.empty() || nats(other, again) + noise->price > nats(*price, found)) return false;
  noise = find_uneven_noise(other, again.labels);
  if (!noise) return false;  // the regions differ, not places
  found = std::move(again);
  price.emplace(std::move(other));
  to.uneven_noise = noise->growth;
  return true;
}

void follow_noise_law(std::span<const float> values, Partition& found, std::optional<PartitionPrice>& price,
                      const PartitionSearch& search, Disturbances& to) {
  const std::optional<NoiseLaw> law = noise_law(values, price->grid(), found.labels, price->mask());
  if (!law) return;
  to.noise_growth = law->growth();
  std::vector<float> even = even_noise(values, *law);
  price.emplace(search.price(even));
  Partition again = search.find(*price, found.model, found.labels);
  again.prices = found.prices;
  if (!again.labels.empty()) found = std::move(again);
  to.values = std::move(even);
}

}  // namespace

Disturbances leave_out_disturbances(std::span<const float> values, Partition& found,
                                    std::optional<PartitionPrice>& price, const PartitionSearch& search) {
  Disturbances result;
  const bool two = std::all_of(found.labels.begin(), found.labels.end(), [](std::uint8_t k) { return k < 2; });
  if (two && leave_out_fringes(values, found, price, search, result)) values = result.values;
  if (!two || !follow_uneven_noise(values, found, price, search, result))
    follow_noise_law(values, found, price, search, result);
  return result;
}

}  // namespace csrbf
