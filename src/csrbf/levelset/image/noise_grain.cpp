#include "csrbf/levelset/image/noise_grain.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace csrbf {
namespace {

// Correlation of voxels `lag` apart along an axis.
double correlation(std::span<const float> residual, const Grid& grid, std::span<const std::uint8_t> mask, int axis,
                   Index lag) {
  Index stride = 1;
  for (int a = 0; a < axis; ++a) stride *= grid.size[a];
  double products = 0, squares = 0;
  for (Index i = 0; i < grid.voxels(); ++i) {
    const Index j = i + lag * stride;
    if (i / stride % grid.size[axis] + lag >= grid.size[axis]) continue;
    if (!mask.empty() && (mask[i] == 0 || mask[j] == 0)) continue;
    const auto x = static_cast<double>(residual[i]), y = static_cast<double>(residual[j]);
    products += x * y;
    squares += 0.5 * (x * x + y * y);
  }
  return squares > 0 ? products / squares : 0;
}

}  // namespace

double noise_grain(std::span<const float> residual, const Grid& grid, std::span<const std::uint8_t> mask) {
  constexpr double least = 0.3, most = 0.97;  // of neighbours; as of speckle
  constexpr double none = 0.2;                // beyond the grain; more is structure
  double voxels = 1, largest = 0;
  for (int axis = 0; axis < grid.dimension(); ++axis) {
    const double alike = correlation(residual, grid, mask, axis, 1);
    if (alike > most) return 1;
    largest = std::max(largest, alike);
    if (alike <= 0) continue;
    // A Gaussian of deviation s blurs noise to correlations of exp(-lag^2 / (4 s^2)).
    const double s = std::sqrt(-0.25 / std::log(alike));
    const auto far = static_cast<Index>(std::ceil(4 * s)) + 1;
    if (correlation(residual, grid, mask, axis, far) > none) return 1;
    voxels *= std::max(1.0, std::sqrt(4 * std::numbers::pi) * s);
  }
  return largest > least ? voxels : 1;
}

}  // namespace csrbf
