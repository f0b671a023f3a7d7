#include "csrbf/levelset/segment_local.hpp"

#include "csrbf/levelset/image/signed_distance.hpp"

#include <cmath>
#include <numbers>

namespace csrbf {

double spacing_for_ball(const Grid& grid, double voxels) {
  constexpr double finest = 2;      // by hand: less follows noise
  constexpr double per_radius = 3;  // centres; by hand: fewer shrink balls, more follow noise
  const double edge = grid.spacing.head(grid.dimension()).minCoeff();
  double volume = voxels;
  for (int a = 0; a < grid.dimension(); ++a) volume *= grid.spacing[a] / edge;
  const double radius =
      grid.dimension() == 2 ? std::sqrt(volume / std::numbers::pi) : std::cbrt(0.75 * volume / std::numbers::pi);
  return std::max(finest, radius / per_radius);
}

std::vector<float> prior_near(const SegmentOptions& options, const Grid& grid, std::span<const std::uint8_t> labels,
                              double distance) {
  std::vector<float> prior = seed_prior(options, grid);
  const std::vector<float> inside = signed_distance(grid, labels.data());
  prior.resize(labels.size(), 0.0F);
  for (std::size_t i = 0; i < inside.size(); ++i)
    if (static_cast<double>(inside[i]) < -distance) prior[i] += certain_prior;
  return prior;
}

}  // namespace csrbf
