#include "csrbf/levelset/image/edgeless_share.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/levelset/image/box_mean.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace csrbf {
namespace {

constexpr double close_by = 3;         // voxels, of the shortest edge: the blur of most images; by hand
constexpr double least_of_edge = 0.1;  // of the median; by hand

// What region 1 is above region 0 at each pair of neighbours of which one lies in either.
struct BorderSteps {
  std::vector<double> close_by;    // by the means of the voxels around the pair
  std::vector<double> neighbours;  // by the two alone
};

BorderSteps border_steps(std::span<const float> values, std::span<const std::uint8_t> labels, const Grid& grid,
                         std::span<const std::uint8_t> mask) {
  const auto inside = [&](std::size_t i) { return mask.empty() || mask[i] != 0; };
  std::array<Index, 3> half{0, 0, 0};
  const double edge = grid.spacing.head(grid.dimension()).minCoeff();
  for (int a = 0; a < grid.dimension(); ++a)
    half[a] = std::max<Index>(1, std::lround(close_by * edge / grid.spacing[a]));
  std::array<std::vector<float>, 2> sums, shares;
  for (std::size_t k = 0; k < 2; ++k) {
    sums[k].resize(values.size());
    shares[k].resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const bool here = inside(i) && (labels[i] != 0) == (k == 1);
      sums[k][i] = here ? values[i] : 0.0F;
      shares[k][i] = here ? 1.0F : 0.0F;
    }
    box_mean(sums[k], grid.size, half);
    box_mean(shares[k], grid.size, half);
  }
  BorderSteps steps;
  const std::array<Index, 3> strides{1, grid.size[0], grid.size[0] * grid.size[1]};
  for (Index i = 0; i < grid.voxels(); ++i)
    for (int a = 0; a < grid.dimension(); ++a) {
      if (i / strides[a] % grid.size[a] + 1 == grid.size[a]) continue;
      const auto here = static_cast<std::size_t>(i), next = static_cast<std::size_t>(i + strides[a]);
      if ((labels[here] != 0) == (labels[next] != 0) || !inside(here) || !inside(next)) continue;
      steps.close_by.push_back(static_cast<double>(sums[1][here] / shares[1][here] - sums[0][here] / shares[0][here]));
      const auto step = static_cast<double>(values[next] - values[here]);
      steps.neighbours.push_back(labels[next] != 0 ? step : -step);
    }
  return steps;
}

}  // namespace

double edgeless_share(std::span<const float> values, std::span<const std::uint8_t> labels, const Grid& grid,
                      std::span<const std::uint8_t> mask) {
  std::vector<double> steps = border_steps(values, labels, grid, mask).close_by;
  if (steps.empty()) return 0;
  const double typical = median(steps), least = least_of_edge * std::abs(typical), sign = typical < 0 ? -1 : 1;
  const auto none = std::count_if(steps.begin(), steps.end(), [&](double step) { return sign * step < least; });
  return static_cast<double>(none) / static_cast<double>(steps.size());
}

double border_sharpness(std::span<const float> values, std::span<const std::uint8_t> labels, const Grid& grid,
                        std::span<const std::uint8_t> mask) {
  const BorderSteps steps = border_steps(values, labels, grid, mask);
  double close_by = 0, squares = 0, neighbours = 0;
  for (std::size_t i = 0; i < steps.close_by.size(); ++i) {
    close_by += steps.close_by[i];
    squares += steps.close_by[i] * steps.close_by[i];
    neighbours += steps.neighbours[i];
  }
  constexpr double chance = 2;  // deviations of a sum of both signs: a quotient by less says nothing
  return std::abs(close_by) > chance * std::sqrt(squares) ? neighbours / close_by : 0;
}

}  // namespace csrbf
