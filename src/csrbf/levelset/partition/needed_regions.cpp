#include "csrbf/levelset/partition/needed_regions.hpp"

#include "csrbf/levelset/partition/partition_model.hpp"
#include "csrbf/levelset/regions/intensity_histogram.hpp"

#include <algorithm>
#include <vector>

namespace csrbf {

bool are_all_regions_needed(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask,
                            double length, std::span<const std::uint8_t> labels, int regions) {
  const IntensityBins bins = choose_bins(values, 256, mask);
  PartitionPrice price(values, bins.lo, bins.hi, grid, mask, contour_weight(grid, length));
  const PartitionModel model{.own_deviations = true};
  const double with_all = price.fit(labels, model, regions);
  std::vector<std::uint8_t> joined(labels.size());
  for (int label = 1; label < regions; ++label) {
    std::transform(labels.begin(), labels.end(), joined.begin(),
                   [&](std::uint8_t each) { return each >= label ? static_cast<std::uint8_t>(each - 1) : each; });
    if (!(price.fit(joined, model, regions - 1) > with_all)) return false;
  }
  return true;
}

}  // namespace csrbf
