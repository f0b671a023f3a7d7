#include "csrbf/levelset/segment_baselines.hpp"

#include "csrbf/levelset/collocation.hpp"
#include "csrbf/levelset/finite_difference.hpp"

#include <cmath>

namespace csrbf {
namespace {

// The forces of a source and the energy of the labels that they are asked for.
ForceUpdate update_from(const ForceSource& source, std::size_t voxels, std::vector<double>& energy) {
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
BaselineResult<Dim> segment_by_baseline(const Grid& grid, const ForceSource& source, const SegmentOptions& options,
                                        double center_spacing, const std::vector<std::uint8_t>& labels) {
  BaselineResult<Dim> result;
  const ForceUpdate force = update_from(source, labels.size(), result.report.energy);
  if (options.method == SegmentMethod::finite_difference) {
    FiniteDifferenceOptions how;
    how.length = *options.smoothness;
    how.iterations = 10 * options.iterations;  // of half a voxel
    how.progress = options.progress;
    FiniteDifferenceResult<Dim> found = finite_difference<Dim>(grid, labels.data(), force, how);
    result.labels = std::move(found.labels);
    result.field = found.field;
    result.report.iterations = found.iterations;
    result.report.converged = found.converged;
    return result;
  }
  CollocationOptions how;
  how.kernel = options.kernel;
  how.iterations = options.iterations;
  how.support = *options.support;
  how.tolerance = 1e-4;
  how.progress = options.progress;
  if (options.mode == SegmentMode::local) how.eps = 1.25;
  CollocationResult<Dim> found = collocate(grid, regular_nodes<Dim>(grid, center_spacing), labels.data(), force, how);
  result.labels = std::move(found.labels);
  result.field = found.field;
  result.report.iterations = found.iterations;
  result.report.converged = found.converged;
  return result;
}

template BaselineResult<2> segment_by_baseline<2>(const Grid&, const ForceSource&, const SegmentOptions&, double,
                                                  const std::vector<std::uint8_t>&);
template BaselineResult<3> segment_by_baseline<3>(const Grid&, const ForceSource&, const SegmentOptions&, double,
                                                  const std::vector<std::uint8_t>&);

}  // namespace csrbf
