#include "csrbf/levelset/partition/grained_partition.hpp"

#include "csrbf/levelset/image/noise_grain.hpp"
#include "csrbf/levelset/partition/blurred_price.hpp"

namespace csrbf {
namespace {

constexpr double cheaper = 0.6;  // contours where none are worth their price; by hand: 0.4 finds noise more often

double grain_left(PartitionPrice& price, const Partition& found) {
  return noise_grain(fit_blurred(price, found.labels, found.model).residual, price.grid(), price.mask());
}

// In much noise contours may cost more than what they tell apart. The gain that is told stays negative.
bool try_cheaper(PartitionPrice& price, const PartitionOptions& options, Partition& found) {
  price.scale_contours(cheaper);
  Partition other = find_partition(price, options);
  if (!(other.gain > 0)) {
    price.scale_contours(1 / cheaper);
    return false;
  }
  other.gain = found.gain;
  found = std::move(other);
  return true;
}

}  // namespace

Partition find_grained_partition(PartitionPrice& price, const PartitionOptions& options) {
  constexpr int rounds = 3;       // labels that follow the grain hide some of it from the first
  constexpr double grows = 1.25;  // by hand: less changes nothing
  Partition found = find_partition(price, options);
  if (options.regions > 2 || found.labels.empty()) return found;
  Partition clear;  // the last labels that are too clear to be noise
  double grain = 1, clear_grain = 1, now = grain_left(price, found);
  for (int round = 0; round < rounds && now >= grows * grain; ++round) {
    if (found.gain > 0 && are_clear(price, found.labels, found.model)) {
      clear = found;
      clear_grain = grain;
    }
    price.set_grain(now);
    Partition coarse = find_partition(price, options);
    const double then = coarse.labels.empty() ? 1.0 : grain_left(price, coarse);
    // What coarse labels leave out shows structures that the fine ones have; or these were no noise. Objects that fill
    // the image look like a grain, which grows as labels follow fewer of them.
    const bool loses = coarse.gain < 0 && !clear.labels.empty();
    if (loses) {
      found = std::move(clear);
      grain = clear_grain;
    }
    if (then == 1 || loses) {
      price.set_grain(grain);
      break;
    }
    found = std::move(coarse);
    grain = now;
    now = then;
  }
  if (found.gain < 0) try_cheaper(price, options, found);
  if (price.grain() == 1 && price.seeds().empty() && found.gain > 0 && !found.model.own_deviations)
    found.in_blur = place_blurred_contour(price, found.model, found.labels);
  return found;
}

}  // namespace csrbf
