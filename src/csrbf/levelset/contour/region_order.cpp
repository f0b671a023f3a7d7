#include "csrbf/levelset/contour/region_order.hpp"

#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "csrbf/levelset/regions/region_labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

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

// How many pairs of neighbours with labels 0 and 1 lie where region 0 and where region 1 is convex; straight borders
// count for none, as do those of the mask.
std::array<double, 2> convex_borders(std::span<const std::uint8_t> labels, const Grid& grid,
                                     std::span<const std::uint8_t> mask) {
  constexpr double width = 2;        // voxels; with 1 to 4, the shares of objects that touch are the same within .1
  constexpr float straight = 0.02F;  // chosen by hand: a circle of 40 voxels bends more
  double shortest = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
    if (grid.size[a] > 1) shortest = std::min(shortest, grid.spacing[a]);
  std::array<double, 3> sd{};
  for (int a = 0; a < 3; ++a) sd[static_cast<std::size_t>(a)] = width * shortest / grid.spacing[a];
  std::vector<float> mean(labels.begin(), labels.end());
  if (!mask.empty()) {
    std::vector<float> weight(mean.size());
    for (std::size_t i = 0; i < weight.size(); ++i) {
      weight[i] = mask[i] != 0 ? 1.0F : 0.0F;
      mean[i] *= weight[i];
    }
    gaussian_blur(mean, grid.size, sd);
    gaussian_blur(weight, grid.size, sd);
    for (std::size_t i = 0; i < weight.size(); ++i) mean[i] /= std::max(weight[i], 1e-6F);
  } else {
    gaussian_blur(mean, grid.size, sd);
  }
  std::array<double, 2> counts{0, 0};
  const auto [nx, ny, nz] = grid.size;
  for (Index i = 0; i < std::ssize(labels); ++i) {
    const auto compare = [&](bool there, Index other) {
      if (!there || labels[i] == labels[other]) return;
      if (!mask.empty() && (mask[i] == 0 || mask[other] == 0)) return;
      const float bend = mean[i] + mean[other] - 1;
      if (std::abs(bend) > straight) counts[bend < 0 ? 1 : 0] += 1;
    };
    compare(i % nx + 1 < nx, i + 1);
    compare(i / nx % ny + 1 < ny, i + nx);
    compare(i / (nx * ny) + 1 < nz, i + nx * ny);
  }
  return counts;
}

// Where a mask hides most of the border of the image, as a frame around the picture does, its own border counts.
void count_mask_border(std::span<const std::uint8_t> labels, const Grid& grid, std::span<const std::uint8_t> mask,
                       std::vector<Index>& border) {
  std::vector<Index> all(1, 0);
  count_border(labels, grid, {}, 0, grid.size[2], all);
  if (2 * (border[0] + border[1]) >= all[0]) return;
  Index stride = 1;
  for (int a = 0; a < grid.dimension(); ++a) {
    for (Index i = 0; i + stride < grid.voxels(); ++i)
      if (i / stride % grid.size[a] + 1 < grid.size[a] && (mask[i] != 0) != (mask[i + stride] != 0))
        ++border[labels[mask[i] != 0 ? i : i + stride]];
    stride *= grid.size[a];
  }
}

// What has most of the border of the image. Where objects cover about half of it, they are the region that is convex:
// both ratios are evidence, and count alike.
int outer_region(std::span<const std::uint8_t> labels, const Grid& grid, std::span<const std::uint8_t> mask) {
  constexpr double unclear = 0.25;  // share of the border
  constexpr double few = 20;        // pairs; both chosen by hand
  std::vector<Index> border(2, 0);
  count_border(labels, grid, mask, 0, grid.size[2], border);
  if (!mask.empty()) count_mask_border(labels, grid, mask, border);
  const int most = border[1] > border[0] ? 1 : 0;
  const auto a = static_cast<double>(border[most]), b = static_cast<double>(border[1 - most]);
  if (b < unclear * (a + b)) return most;
  std::array<double, 2> convex = convex_borders(labels, grid, mask);
  const double chance = few + 2 * std::sqrt(convex[0] + convex[1]);  // what is no more than that says nothing
  for (double& count : convex) count += chance;
  const auto first = static_cast<std::size_t>(most);
  return a * convex[1 - first] < b * convex[first] ? 1 - most : most;
}

// The region that the seed does not mark; -1 without a seed and where it marks both alike.
int outside_of_seed(const SegmentOptions& options, const VariationalResult& result) {
  if (options.seed.empty()) return -1;
  const int inside = seeded_region(result.labels, options.seed, options.mask);
  return inside >= 0 ? 1 - inside : -1;
}

// Makes that region label 0.
void put_outside(int outside, VariationalResult& result) {
  if (outside == 0) return;
  for (std::uint8_t& label : result.labels) label = 1 - label;
  for (std::vector<float>& set : result.coefficients)
    for (float& c : set) c = -c;
}

}  // namespace

void choose_polarity(const Grid& grid, const SegmentOptions& options, std::span<const float> values,
                     VariationalResult& result) {
  if (options.regions > 2) {
    sort_by_mean(values, options, result);
    return;
  }
  const int seeded = outside_of_seed(options, result);
  put_outside(seeded >= 0 ? seeded : outer_region(result.labels, grid, options.mask), result);
}

void choose_polarity_of_large(const Grid& grid, const SegmentOptions& options, VariationalResult& result) {
  const int seeded = outside_of_seed(options, result);
  put_outside(seeded >= 0 ? seeded : border_region(result.labels, grid, options.mask, 2), result);
}

}  // namespace csrbf
