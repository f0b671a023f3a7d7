#include "csrbf/levelset/image/common_background.hpp"

#include "csrbf/levelset/image/box_mean.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace csrbf {

LocalMean::LocalMean(const Grid& grid, double reach) {
  double longest = 0;
  for (int a = 0; a < 3; ++a) longest = std::max(longest, static_cast<double>(grid.size[a]) * grid.spacing[a]);
  for (int a = 0; a < grid.dimension(); ++a) {
    Index& half = half_width[static_cast<std::size_t>(a)];
    half = std::clamp<Index>(std::lround(reach * longest / grid.spacing[a]), 1, grid.size[a]);
    const double area = 2 * std::sqrt(std::numbers::pi) * static_cast<double>(half);
    parameters *= std::max(1.0, static_cast<double>(grid.size[a]) / area);
  }
}

// Three boxes have about the profile, and the standard deviation, of a Gaussian of their half width.
void LocalMean::average(std::span<float> values, const Grid& grid) const {
  for (int pass = 0; pass < 3; ++pass) box_mean(values, grid.size, half_width);
}

std::vector<std::vector<float>> means_in_background(std::span<const float> values, std::span<const std::uint8_t> labels,
                                                    std::span<const std::uint8_t> mask, const Grid& grid,
                                                    const LocalMean& local_mean, std::vector<double>& means) {
  constexpr int rounds = 3;  // by hand: more change nothing
  const auto inside = [&](std::size_t i) { return mask.empty() || mask[i] != 0; };
  std::vector<float> weight, background(values.size());
  if (!mask.empty()) {
    for (const std::uint8_t each : mask) weight.push_back(each != 0 ? 1.0F : 0.0F);
    local_mean.average(weight, grid);
  }
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < values.size(); ++i)
      background[i] = inside(i) ? values[i] - static_cast<float>(means[labels[i]]) : 0.0F;
    local_mean.average(background, grid);
    std::vector<double> sums(means.size(), 0), counts(means.size(), 0);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!inside(i)) continue;
      if (!weight.empty()) background[i] /= weight[i];
      sums[labels[i]] += static_cast<double>(values[i] - background[i]);
      counts[labels[i]] += 1;
    }
    for (std::size_t k = 0; k < means.size(); ++k) means[k] = sums[k] / counts[k];
  }
  std::vector<std::vector<float>> fields(means.size(), background);
  for (std::size_t k = 0; k < means.size(); ++k)
    for (float& each : fields[k]) each += static_cast<float>(means[k]);
  return fields;
}

}  // namespace csrbf
