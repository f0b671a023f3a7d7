#include "csrbf/levelset/image/signed_distance.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/distance_transform.hpp"

namespace csrbf {

std::vector<float> signed_distance(const Grid& grid, const unsigned char* labels) {
  constexpr Index grain = 1 << 15;  // voxels per task
  const auto n = static_cast<std::size_t>(grid.voxels());
  double half = std::numeric_limits<double>::infinity(), diagonal2 = 0;
  for (Index a = 0; a < 3; ++a) {
    const double edge = grid.spacing[a];
    if (grid.size[a] == 1) continue;
    half = std::min(half, 0.5 * edge);
    diagonal2 += std::pow(edge * static_cast<double>(grid.size[a]), 2);
  }
  if (!std::isfinite(half)) half = 0;
  const auto diagonal = static_cast<float>(std::sqrt(diagonal2)), less = static_cast<float>(half);
  std::vector<float> distance(n);
  std::vector<std::uint8_t> marked(n);
  for (const bool inside : {true, false}) {
    std::transform(labels, labels + n, marked.begin(),
                   [inside](unsigned char label) -> std::uint8_t { return (label != 0) == inside ? 0 : 1; });
    const std::vector<float> other = distance_transform(grid.size, grid.spacing, marked);
    parallel_for(grid.voxels(), grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        if (marked[i] == 0) distance[i] = (inside ? 1.F : -1.F) * (std::min(other[i], diagonal) - less);
    });
  }
  return distance;
}

}  // namespace csrbf
