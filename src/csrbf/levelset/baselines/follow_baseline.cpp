#include "csrbf/levelset/baselines/follow_baseline.hpp"

#include "csrbf/levelset/baselines/collocation.hpp"
#include "csrbf/levelset/baselines/finite_difference.hpp"

#include <cmath>

namespace csrbf {
namespace {

// The forces of a source. Appends the energy of the labels that they are asked for.
ForceUpdate baseline_forces(ForceSource& source, std::size_t voxels, std::vector<double>& energy) {
  return [&source, voxels, &energy](const unsigned char* labels, float* force) {
    source.fit({labels, voxels});
    double sum = source.force(1, 1, {force, voxels}), size = 0;
    for (std::size_t i = 0; i < voxels; ++i) {
      size += static_cast<double>(std::abs(force[i]));
      if (labels[i] != 0) sum += static_cast<double>(force[i]);
    }
    energy.push_back(sum / (size > 0 ? size : 1));
  };
}

}  // namespace

template <int Dim>
BaselineResult<Dim> follow_baseline(const Grid& grid, const SegmentSettings& settings, const Progress& progress,
                                    ForceSource& source, const std::vector<std::uint8_t>& start) {
  std::vector<double> energy;
  const auto result = [&](auto&& found) {
    return BaselineResult<Dim>{found.field, std::move(found.labels), found.iterations, found.converged,
                               std::move(energy)};
  };
  const ForceUpdate force = baseline_forces(source, start.size(), energy);
  if (settings.method == SegmentMethod::finite_difference)
    return result(finite_difference<Dim>(grid, start.data(), force,
                                         {.length = *settings.smoothness,
                                          .iterations = 10 * settings.iterations,  // of half a voxel
                                          .progress = progress}));
  const bool local = settings.mode == SegmentMode::local;
  return result(collocate(grid, regular_nodes<Dim>(grid, *settings.center_spacing), start.data(), force,
                          {.kernel = settings.kernel,
                           .support = *settings.support,
                           .eps = local ? 1.25 : 0,  // only the contour moves, or all level curves
                           .iterations = settings.iterations,
                           .tolerance = 1e-4,
                           .progress = progress}));
}

template BaselineResult<2> follow_baseline<2>(const Grid&, const SegmentSettings&, const Progress&, ForceSource&,
                                              const std::vector<std::uint8_t>&);
template BaselineResult<3> follow_baseline<3>(const Grid&, const SegmentSettings&, const Progress&, ForceSource&,
                                              const std::vector<std::uint8_t>&);

}  // namespace csrbf
