#include "csrbf/levelset/disturbances/uneven_noise.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/levelset/image/box_mean.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace csrbf {
namespace {

constexpr double least_growth = 2;  // by hand: below, nothing is lost
constexpr double rare = 0.02;       // of the voxels, at both ends, that growth leaves out
constexpr double part = 1.0 / 8;    // of the longest side, that local means are taken over; by hand

// Logarithms of the squares of second differences in the window around each voxel, or close to it at the border.
std::vector<float> logarithms(const PartitionPrice& price) {
  const auto [nx, ny, nz] = price.grid().size;
  const std::span<const float> values = price.values();
  std::vector<float> result(values.size());
  const auto least = static_cast<float>(std::pow(price.least_deviation(), 2));
  for (Index z = 0; z < nz; ++z)
    for (Index y = 0; y < ny; ++y)
      for (Index x = 0; x < nx; ++x) {
        const Index u = std::clamp<Index>(x, 1, nx - 2), v = std::clamp<Index>(y, 1, ny - 2);
        float difference = 0;
        for (Index j = -1; j < 2; ++j)
          for (Index i = -1; i < 2; ++i)
            difference +=
                static_cast<float>((i == 0 ? -2 : 1) * (j == 0 ? -2 : 1)) * values[(z * ny + v + j) * nx + u + i];
        result[(z * ny + y) * nx + x] = std::log(difference * difference / 36 + least);
      }
  return result;
}

// Leaves out what the regions differ by, and windows at their border, where they differ, too.
void center(std::vector<float>& noise, std::span<const std::uint8_t> labels, const PartitionPrice& price) {
  const auto [nx, ny, nz] = price.grid().size;
  std::vector<std::uint8_t> whole(noise.size(), 1);
  for (Index row = 0; row < ny * nz; ++row)
    for (Index x = 0; x < nx; ++x) {
      const std::uint8_t* here = labels.data() + row * nx + x;
      const Index y = row % ny;
      if ((x + 1 < nx && here[1] != here[0]) || (x > 0 && here[-1] != here[0]) || (y + 1 < ny && here[nx] != here[0]) ||
          (y > 0 && here[-nx] != here[0]))
        for (Index j = std::max<Index>(0, y - 1); j <= std::min(ny - 1, y + 1); ++j)
          for (Index i = std::max<Index>(0, x - 1); i <= std::min(nx - 1, x + 1); ++i)
            whole[(row - y + j) * nx + i] = 0;
    }
  std::array<double, 2> sums{0, 0}, counts{0, 0};
  for (std::size_t i = 0; i < noise.size(); ++i) {
    if (!price.inside(i) || whole[i] == 0) continue;
    sums[labels[i] != 0 ? 1 : 0] += static_cast<double>(noise[i]);
    counts[labels[i] != 0 ? 1 : 0] += 1;
  }
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const std::size_t k = labels[i] != 0 ? 1 : 0;
    noise[i] = whole[i] != 0 ? noise[i] - static_cast<float>(sums[k] / std::max(counts[k], 1.0)) : 0.0F;
  }
}

// Of what the trend leaves; returns how many numbers that and the trend take.
double add_local_mean(const std::vector<float>& noise, const PartitionPrice& price, std::vector<float>& trend) {
  const Grid& grid = price.grid();
  const double side = part * static_cast<double>(*std::max_element(grid.size.begin(), grid.size.end()));
  std::array<Index, 3> half{0, 0, 0};
  double parameters = grid.dimension() == 2 ? 6 : 10;
  double parts = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (grid.size[a] == 1) continue;
    half[a] = std::max<Index>(2, std::lround(0.5 * side));
    parts *= std::max(1.0, static_cast<double>(grid.size[a]) / side);
  }
  std::vector<float> rest(noise.size(), 0.0F), weight(noise.size(), 0.0F);
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (price.inside(i)) {
      rest[i] = noise[i] - trend[i];
      weight[i] = 1;
    }
  box_mean(rest, grid.size, half);
  box_mean(weight, grid.size, half);
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (price.inside(i)) trend[i] += rest[i] / weight[i];
  return parameters + parts;
}

}  // namespace

std::optional<UnevenNoise> find_uneven_noise(const PartitionPrice& price, std::span<const std::uint8_t> labels) {
  const Grid& grid = price.grid();
  if (grid.size[0] < 3 || grid.size[1] < 3) return std::nullopt;
  std::vector<float> noise = logarithms(price);
  if (!labels.empty()) center(noise, labels, price);
  std::vector<float> trend(noise.size());
  price.fill_trend(noise, 2, trend);
  const double parameters = add_local_mean(noise, price, trend);
  std::vector<float> sorted;
  double sum = 0;
  for (std::size_t i = 0; i < trend.size(); ++i) {
    if (!price.inside(i)) continue;
    sorted.push_back(trend[i]);
    sum += static_cast<double>(trend[i]);
  }
  const auto mean = static_cast<float>(sum / static_cast<double>(sorted.size()));
  const auto least = static_cast<double>(percentile(sorted, rare)),
             most = static_cast<double>(percentile(sorted, 1 - rare));
  UnevenNoise found{{}, std::exp(0.5 * (most - least)), 0.5 * parameters * std::log(price.voxels())};
  if (!(found.growth >= least_growth)) return std::nullopt;
  for (float& each : trend) each = std::exp(mean - each);
  found.certainty = std::move(trend);
  return found;
}

}  // namespace csrbf
