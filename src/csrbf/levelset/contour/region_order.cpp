#include "csrbf/levelset/contour/region_order.hpp"

#include "csrbf/levelset/regions/region_labels.hpp"

#include <limits>

namespace csrbf {
namespace {

// Brings the labels of several regions in the order of their means.
void sort_by_mean(std::span<const float> values, const SegmentOptions& options, VariationalResult& result) {
  const auto n = static_cast<std::size_t>(options.regions);
  std::vector<double> sums(n, 0), counts(n, 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!options.mask.empty() && options.mask[i] == 0) continue;
    sums[result.labels[i]] += static_cast<double>(values[i]);
    counts[result.labels[i]] += 1;
  }
  std::vector<std::uint8_t> order(n), place(n);
  for (std::size_t k = 0; k < n; ++k) order[k] = static_cast<std::uint8_t>(k);
  const auto mean = [&](std::uint8_t k) {  // empty regions last
    return counts[k] > 0 ? sums[k] / counts[k] : std::numeric_limits<double>::infinity();
  };
  std::stable_sort(order.begin(), order.end(), [&](std::uint8_t a, std::uint8_t b) { return mean(a) < mean(b); });
  std::vector<std::vector<float>> sorted;
  for (std::size_t k = 0; k < n; ++k) {
    place[order[k]] = static_cast<std::uint8_t>(k);
    sorted.push_back(std::move(result.coefficients[order[k]]));
  }
  result.coefficients = std::move(sorted);
  for (std::uint8_t& label : result.labels) label = place[label];
}

}  // namespace

void choose_polarity(const Grid& grid, const SegmentOptions& options, std::span<const float> values,
                     VariationalResult& result) {
  if (options.regions > 2) {
    sort_by_mean(values, options, result);
    return;
  }
  int outside = -1;
  if (!options.seed.empty()) {
    const int inside = seeded_region(result.labels, options.seed, options.mask);
    if (inside >= 0) outside = 1 - inside;
  }
  if (outside < 0) outside = border_region(result.labels, grid, options.mask, options.regions);
  if (outside == 0) return;
  for (std::uint8_t& label : result.labels) label = 1 - label;
  for (std::vector<float>& set : result.coefficients)
    for (float& c : set) c = -c;
}

}  // namespace csrbf
