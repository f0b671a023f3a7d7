#include "csrbf/levelset/image/noise_law.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace csrbf {
namespace {

constexpr std::size_t intervals = 32;       // of intensities
constexpr std::size_t enough_windows = 50;  // windows in an interval
constexpr double kept = 0.75;               // of them; the others show edges
constexpr double kept_squares = 0.3684;     // mean square of normal x below that quantile of |x|, of deviation 1
constexpr double uneven = 2;                // ratio of variances; by hand: estimates of even noise are within it
constexpr double least_core = 0.2;          // see core_share(); by hand: dots and vessels of up to 7 voxels have less
constexpr double power = 0.2;          // of the variance; the best of 0 to 0.375 on most halves of 46 images of nuclei
constexpr double quantum = 1.0 / 512;  // of the range: half a grey level of 256, the least deviation

struct Windows {
  std::vector<float> means, differences;
};

// The least share of a region, in planes across the last axis of a volume, that is farther than two voxels from its
// border.
double core_share(std::span<const std::uint8_t> labels, const Grid& grid) {
  constexpr Index reach = 2;
  const auto [nx, ny, nz] = grid.size;
  std::array<double, 256> cores{}, counts{};
  std::vector<std::uint8_t> even(labels.size());  // along x
  for (Index row = 0; row < ny * nz; ++row)
    for (Index x = 0; x < nx; ++x) {
      const std::uint8_t* at = labels.data() + row * nx;
      bool same = true;
      for (Index i = std::max<Index>(0, x - reach); i <= std::min(nx - 1, x + reach); ++i)
        same = same && at[i] == at[x];
      even[row * nx + x] = same ? 1 : 0;
    }
  for (Index row = 0; row < ny * nz; ++row)
    for (Index x = 0; x < nx; ++x) {
      const Index y = row % ny, first = std::max<Index>(0, y - reach), last = std::min(ny - 1, y + reach);
      const std::uint8_t label = labels[row * nx + x];
      bool same = true;
      for (Index j = row - y + first; j <= row - y + last; ++j)
        same = same && even[j * nx + x] != 0 && labels[j * nx + x] == label;
      counts[label] += 1;
      cores[label] += same ? 1 : 0;
    }
  double least = 1;
  for (std::size_t k = 0; k < counts.size(); ++k)
    if (counts[k] > 0) least = std::min(least, cores[k] / counts[k]);
  return least;
}

// Of those that lie inside the image, the mask and one region.
Windows gather(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> labels,
               std::span<const std::uint8_t> mask) {
  const auto [nx, ny, nz] = grid.size;
  const Index across = nx - 2, down = ny - 2;
  Windows found;
  if (across < 1 || down < 1) return found;
  const auto count = static_cast<std::size_t>(across * down * nz);
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  found.means.assign(count, none);
  found.differences.assign(count, none);
  parallel_for(down * nz, 16, [&, nx = nx, ny = ny](Index begin, Index end) {
    for (Index row = begin; row < end; ++row) {
      const Index corner = (row / down * ny + row % down) * nx;
      for (Index x = 0; x < across; ++x) {
        float sum = 0, difference = 0;
        bool inside = true;
        for (Index j = 0; j < 3; ++j)
          for (Index i = 0; i < 3; ++i) {
            const Index at = corner + j * nx + x + i;
            inside = inside && labels[at] == labels[corner + x] && (mask.empty() || mask[at] != 0);
            sum += values[at];
            difference += static_cast<float>((i == 1 ? -2 : 1) * (j == 1 ? -2 : 1)) * values[at];
          }
        if (!inside) continue;
        found.means[row * across + x] = sum / 9;
        found.differences[row * across + x] = difference / 6;  // of the deviation of the noise
      }
    }
  });
  std::size_t kept_count = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::isnan(found.means[i])) continue;
    found.means[kept_count] = found.means[i];
    found.differences[kept_count++] = found.differences[i];
  }
  found.means.resize(kept_count);
  found.differences.resize(kept_count);
  return found;
}

double trimmed_variance(std::vector<float>& squares) {
  const auto count = static_cast<std::ptrdiff_t>(kept * static_cast<double>(squares.size()));
  std::nth_element(squares.begin(), squares.begin() + count, squares.end());
  double sum = 0;
  for (auto it = squares.begin(); it != squares.begin() + count; ++it) sum += static_cast<double>(*it);
  return sum / (kept_squares * static_cast<double>(count));
}

struct Level {
  double intensity, variance;
};

// Least squares of relative errors: a straight line, intensity = 0 at lo and 1 at hi, and its values there.
std::array<double, 2> fit_line(const std::vector<Level>& levels) {
  constexpr int rounds = 5;  // of weights
  std::array<double, 2> ends{0, 0};
  double mean = 0;
  for (const Level& each : levels) mean += each.variance / static_cast<double>(levels.size());
  for (int round = 0; round < rounds; ++round) {
    double s0 = 0, s1 = 0, s2 = 0, v0 = 0, v1 = 0;
    for (const Level& each : levels) {
      const double t = each.intensity, fitted = ends[0] + (ends[1] - ends[0]) * t;
      const double size = round == 0 ? each.variance : std::max(fitted, 0.05 * mean), w = 1 / (size * size);
      s0 += w;
      s1 += w * t;
      s2 += w * t * t;
      v0 += w * each.variance;
      v1 += w * t * each.variance;
    }
    const double slope = (s0 * v1 - s1 * v0) / (s0 * s2 - s1 * s1), at_lo = (v0 - slope * s1) / s0;
    ends = {at_lo, at_lo + slope};
  }
  return ends;
}

}  // namespace

std::optional<NoiseLaw> noise_law(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> labels,
                                  std::span<const std::uint8_t> mask) {
  if (core_share(labels, grid) < least_core) return std::nullopt;
  Windows windows = gather(values, grid, labels, mask);
  if (windows.means.size() < 2 * enough_windows) return std::nullopt;
  std::vector<float> sorted = windows.means;
  const auto lo = static_cast<double>(percentile(sorted, 0.01)), hi = static_cast<double>(percentile(sorted, 0.998));
  if (!(hi > lo)) return std::nullopt;
  std::array<std::vector<float>, intervals> squares;
  for (std::size_t i = 0; i < windows.means.size(); ++i) {
    const double t = (static_cast<double>(windows.means[i]) - lo) / (hi - lo);
    if (t < 0 || t > 1) continue;
    const float d = windows.differences[i];
    squares[std::min(intervals - 1, static_cast<std::size_t>(t * intervals))].push_back(d * d);
  }
  std::vector<Level> levels;
  for (std::size_t k = 0; k < intervals; ++k)
    if (squares[k].size() >= enough_windows)
      levels.push_back({(static_cast<double>(k) + 0.5) / intervals,
                        trimmed_variance(squares[k]) + std::pow(quantum * (hi - lo), 2)});
  if (levels.size() < 3) return std::nullopt;
  const std::array<double, 2> ends = fit_line(levels);
  // The line is no guide far below what is seen at its ends.
  const NoiseLaw law{lo, hi, std::max(ends[0], 0.5 * levels.front().variance),
                     std::max(ends[1], 0.5 * levels.back().variance)};
  if (law.variance < uneven * law.dark_variance) return std::nullopt;
  return law;
}

std::vector<float> even_noise(std::span<const float> values, const NoiseLaw& law) {
  // variance^(1 - power) is the integral of variance^(-power), up to a factor, as the variance is linear.
  const double dark = std::pow(law.dark_variance, 1 - power), bright = std::pow(law.variance, 1 - power);
  const double slope = (1 - power) * (law.variance - law.dark_variance) / (bright - dark);
  std::vector<float> result(values.size());
  parallel_for(std::ssize(values), 1 << 14, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const double t = (static_cast<double>(values[i]) - law.lo) / (law.hi - law.lo), at = std::clamp(t, 0.0, 1.0);
      const double variance = law.dark_variance + at * (law.variance - law.dark_variance);
      // Beyond the ends it goes on as a straight line.
      const double even =
          (std::pow(variance, 1 - power) - dark) / (bright - dark) + (t - at) * slope * std::pow(variance, -power);
      result[i] = static_cast<float>(law.lo + even * (law.hi - law.lo));
    }
  });
  return result;
}

}  // namespace csrbf
