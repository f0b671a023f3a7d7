#include "csrbf/levelset/seeded/ring_force.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "csrbf/levelset/image/signed_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace csrbf {
namespace {

// By hand, in voxels of the shortest edge: a camera blurs what is nearer to the contour.
constexpr double ring_begin = 0.95, ring_end = 2.5;
constexpr double ring_reach = 1.5;  // standard deviation of the mean along the ring
constexpr double ring_band = 2.5;   // depth to which the contour may move

// Sums near each voxel over the ring at one side.
struct Ring {
  std::vector<float> shares, sums;
  double mean = 0;  // of all of it
};

Ring ring_at(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask,
             std::span<const float> depth, double side, double edge, double begin = ring_begin) {
  Ring ring{std::vector<float>(values.size(), 0.0F), std::vector<float>(values.size(), 0.0F)};
  double count = 0, sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double d = side * static_cast<double>(depth[i]) / edge;
    if (d < begin || d > ring_end || (!mask.empty() && mask[i] == 0)) continue;
    ring.shares[i] = 1;
    ring.sums[i] = values[i];
    ++count;
    sum += static_cast<double>(values[i]);
  }
  if (count == 0 && begin > 0) return ring_at(values, grid, mask, depth, side, edge, 0);  // too thin for a ring
  if (count > 0) ring.mean = sum / count;
  std::array<double, 3> sd{0, 0, 0};
  for (int a = 0; a < grid.dimension(); ++a) sd[a] = ring_reach * edge / grid.spacing[a];
  gaussian_blur(ring.shares, grid.size, sd);
  gaussian_blur(ring.sums, grid.size, sd);
  return ring;
}

}  // namespace

RingForce ring_force(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask,
                     std::span<const std::uint8_t> labels) {
  const double edge = grid.spacing.head(grid.dimension()).minCoeff();
  const std::vector<float> depth = signed_distance(grid, labels.data());
  const Ring inner = ring_at(values, grid, mask, depth, 1, edge), outer = ring_at(values, grid, mask, depth, -1, edge);
  constexpr double none = 1e-4, of_all = 0.02;  // shares: below it there is no ring; of the mean of all of it
  std::vector<float> force(values.size());
  std::vector<double> contrasts;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto shares = static_cast<double>(outer.shares[i]);
    force[i] = depth[i] > 0 ? -0.5F : 0.5F;
    if (std::abs(static_cast<double>(depth[i])) > ring_band * edge || shares < none) continue;
    const double outside = static_cast<double>(outer.sums[i]) / shares;
    const double inside =
        (static_cast<double>(inner.sums[i]) + of_all * inner.mean) / (static_cast<double>(inner.shares[i]) + of_all);
    const double contrast = inside - outside;
    if (std::abs(static_cast<double>(depth[i])) <= edge) contrasts.push_back(std::abs(contrast));
    if (contrast == 0) continue;
    const double middle = 0.5 * (inside + outside);
    force[i] = static_cast<float>(std::clamp((middle - static_cast<double>(values[i])) / contrast, -6.0, 6.0));
  }
  return {std::move(force), contrasts.empty() ? 0 : median(contrasts)};
}

}  // namespace csrbf
