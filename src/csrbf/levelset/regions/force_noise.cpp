#include "csrbf/levelset/regions/force_noise.hpp"

#include "csrbf/core/parallel_sum.hpp"
#include "csrbf/core/percentile.hpp"

namespace csrbf {

double mean_magnitude(std::span<const float> force) {
  constexpr Index grain = 1 << 16;  // voxels per task
  const auto n = std::ssize(force);
  return parallel_sum(n, grain,
                      [&](Index begin, Index end) {
                        double sum = 0;
                        for (Index i = begin; i < end; ++i) sum += static_cast<double>(std::abs(force[i]));
                        return sum;
                      }) /
         static_cast<double>(n);
}

ForceNoise force_noise(std::span<const float> force, std::span<const std::uint8_t> labels,
                       std::span<const std::uint8_t> mask, const Grid& grid) {
  constexpr std::size_t enough = 50000;  // voxels sampled, for a deviation to about half a percent
  constexpr std::size_t far = 3;         // voxels apart, as ForceNoise::grain goes up to 3
  const auto takes_part = [&](std::size_t i) { return mask.empty() || mask[i] != 0; };
  // Larger forces count as clear and are clipped, as in the targets of the level set.
  const auto clear = static_cast<float>(2 * mean_magnitude(force));
  const auto at = [&](std::size_t i) { return static_cast<double>(std::clamp(force[i], -clear, clear)); };
  std::array<double, 2> sums{0, 0}, counts{0, 0};
  // Second differences of neighbours, and of voxels three apart in a region.
  std::array<std::vector<double>, 2> differences;
  const std::size_t step = std::max<std::size_t>(1, force.size() / enough) | 1;
  const auto nx = static_cast<std::size_t>(grid.size[0]);
  for (std::size_t i = 0; i < force.size(); i += step) {
    if (!takes_part(i)) continue;
    const std::size_t k = labels[i] != 0 ? 1 : 0;
    sums[k] += at(i);
    counts[k] += 1;
    const std::size_t x = i % nx;
    if (x == 0 || x + 1 >= nx || !takes_part(i - 1) || !takes_part(i + 1)) continue;
    differences[0].push_back(std::abs(at(i - 1) - 2 * at(i) + at(i + 1)));
    if (x < 2 * far || x + 2 * far >= nx) continue;
    bool inside = true;
    for (std::size_t j = i - 2 * far; j <= i + 2 * far; ++j) inside = inside && labels[j] == labels[i] && takes_part(j);
    if (inside) differences[1].push_back(std::abs(at(i - far) - 2 * at(i) + at(i + far)));
  }
  const double gap = sums[0] / std::max(counts[0], 1.0) - sums[1] / std::max(counts[1], 1.0);
  if (differences[0].empty()) return {};
  const auto deviation = [](std::vector<double>& values) {
    return median(values) / (median_of_normal * std::sqrt(6.0));
  };
  constexpr std::size_t few = 200;  // differences: fewer give the deviation to 8 % at best
  const double near = deviation(differences[0]);
  if (!(gap > 0)) return {near > 0 ? 1.0 : 0.0, 1};
  if (differences[1].size() < few) return {near / gap, 1};
  const double apart = deviation(differences[1]);
  return {std::max(near, apart) / gap, near > 0 ? std::clamp(std::sqrt(apart / near), 1.0, 3.0) : 1};
}

ForceNoise force_noise(const ForceSource& source, std::span<const std::uint8_t> labels,
                       std::span<const std::uint8_t> mask, const Grid& grid) {
  ForceNoise noise;
  std::vector<float> force(labels.size());
  std::vector<std::uint8_t> is_k(labels.size());
  for (int k = source.regions() == 2 ? 1 : 0; k < source.regions(); ++k) {
    source.force(k, 1, force);
    for (std::size_t i = 0; i < labels.size(); ++i) is_k[i] = labels[i] == k ? 1 : 0;
    const ForceNoise found = force_noise(force, is_k, mask, grid);
    noise = {std::max(noise.size, found.size), std::max(noise.grain, found.grain)};
  }
  return noise;
}

double choose_center_spacing(const ForceNoise& noise, int dimension) {
  // Measured: 2 voxels are best for a noise of 2 % of the contrast, 4 for 15 %; in a volume more voxels share a center.
  const double spacing = 2 * noise.grain * std::cbrt(noise.size / 0.02) * (dimension == 3 ? 0.75 : 1.0);
  return std::round(std::clamp(spacing, 2.0, 12.0));
}

}  // namespace csrbf
