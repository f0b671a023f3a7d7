#include "csrbf/levelset/disturbances/calm_partition.hpp"

#include "csrbf/levelset/disturbances/uneven_noise.hpp"
#include "csrbf/levelset/image/noise_law.hpp"
#include "csrbf/levelset/partition/blurred_price.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace csrbf {
namespace {

bool follow_uneven_noise(std::span<const float> values, Partition& found, std::optional<PartitionPrice>& price,
                         const PartitionSearch& search, FollowedNoise& to) {
  std::optional<UnevenNoise> noise = find_uneven_noise(*price);
  if (!noise || !find_uneven_noise(*price, found.labels)) return false;  // or the regions differ, not places
  PartitionPrice other = search.price(values);
  other.set_certainty(std::move(noise->certainty));
  Partition again = search.find(other, {}, {});
  const auto nats = [](PartitionPrice& of, const Partition& by) {
    return of.grain() * fit_blurred(of, by.labels, by.model).price;
  };
  if (again.labels.empty() || nats(other, again) + noise->price > nats(*price, found)) return false;
  noise = find_uneven_noise(other, again.labels);
  if (!noise) return false;
  found = std::move(again);
  price.emplace(std::move(other));
  to.uneven_noise = noise->growth;
  return true;
}

void follow_noise_law(std::span<const float> values, Partition& found, std::optional<PartitionPrice>& price,
                      const PartitionSearch& search, FollowedNoise& to) {
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

FollowedNoise follow_noise(std::span<const float> values, Partition& found, std::optional<PartitionPrice>& price,
                           const PartitionSearch& search) {
  FollowedNoise result;
  const bool two = std::all_of(found.labels.begin(), found.labels.end(), [](std::uint8_t k) { return k < 2; });
  if (!two || !follow_uneven_noise(values, found, price, search, result))
    follow_noise_law(values, found, price, search, result);
  return result;
}

}  // namespace csrbf
