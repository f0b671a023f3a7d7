#include "csrbf/levelset/partition/two_means_price.hpp"

#include "csrbf/levelset/partition/partition_model.hpp"
#include "csrbf/levelset/regions/intensity_histogram.hpp"

namespace csrbf {

TwoMeansPrices two_means_prices(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask,
                                double length, std::span<const std::uint8_t> first,
                                std::span<const std::uint8_t> second) {
  constexpr double clearly = 0.1;  // of the price of the contour; by hand: less is a matter of chance
  const IntensityBins bins = choose_bins(values, 256, mask);
  const ContourWeight weight = contour_weight(grid, length);
  PartitionPrice price(values, bins.lo, bins.hi, grid, mask, weight);
  TwoMeansPrices result{price.fit(first, {}), price.fit(second, {}), false};
  result.second_is_better = result.second < result.first - clearly * contour_price(first, 1, grid.size, weight);
  const double least = result.second_is_better ? result.second : result.first;
  result.first -= least;
  result.second -= least;
  return result;
}

}  // namespace csrbf
