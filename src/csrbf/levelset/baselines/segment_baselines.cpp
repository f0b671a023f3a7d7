#include "csrbf/levelset/baselines/segment_baselines.hpp"

#include "csrbf/levelset/baselines/collocation.hpp"
#include "csrbf/levelset/baselines/finite_difference.hpp"

#include <cmath>

namespace csrbf {
namespace {

// The forces of a source and the energy of the labels that they are asked for.
ForceUpdate update_from(ForceSource& source, std::size_t voxels, std::vector<double>& energy) {
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
BaselineResult<Dim> segment_by_collocation(const Grid& grid, ForceSource& source,
                                           const CollocationBaselineOptions& options,
                                           const std::vector<std::uint8_t>& labels) {
  BaselineResult<Dim> result;
  CollocationOptions how;
  how.kernel = options.kernel;
  how.iterations = options.iterations;
  how.support = options.support;
  how.tolerance = 1e-4;
  how.progress = options.progress;
  if (options.local) how.eps = 1.25;
  CollocationResult<Dim> found = collocate(grid, regular_nodes<Dim>(grid, options.center_spacing), labels.data(),
                                           update_from(source, labels.size(), result.energy), how);
  result.labels = std::move(found.labels);
  result.field = found.field;
  result.iterations = found.iterations;
  result.converged = found.converged;
  return result;
}

template <int Dim>
BaselineResult<Dim> segment_by_finite_difference(const Grid& grid, ForceSource& source,
                                                 const FiniteDifferenceBaselineOptions& options,
                                                 const std::vector<std::uint8_t>& labels) {
  BaselineResult<Dim> result;
  FiniteDifferenceOptions how;
  how.length = options.smoothness;
  how.iterations = 10 * options.iterations;  // of half a voxel
  how.progress = options.progress;
  FiniteDifferenceResult<Dim> found =
      finite_difference<Dim>(grid, labels.data(), update_from(source, labels.size(), result.energy), how);
  result.labels = std::move(found.labels);
  result.field = found.field;
  result.iterations = found.iterations;
  result.converged = found.converged;
  return result;
}

#define CSRBF_INSTANTIATE(Dim)                                                                         \
  template BaselineResult<Dim> segment_by_collocation<Dim>(                                            \
      const Grid&, ForceSource&, const CollocationBaselineOptions&, const std::vector<std::uint8_t>&); \
  template BaselineResult<Dim> segment_by_finite_difference<Dim>(                                      \
      const Grid&, ForceSource&, const FiniteDifferenceBaselineOptions&, const std::vector<std::uint8_t>&);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
