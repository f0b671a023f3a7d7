#include "csrbf/levelset/segment_slices.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/levelset/contour/segment_fields.hpp"
#include "csrbf/levelset/regions/slab_components.hpp"
#include "csrbf/levelset/segment_checks.hpp"

#include <algorithm>
#include <utility>

namespace csrbf {

template <int Dim>
std::optional<Segmentation<Dim>> segment_slices(SliceSource& image, const Grid& grid, const SegmentOptions& options,
                                                const LabelsOfSlices& take) {
  check_segment_options(options);
  require(options.mask.empty() && options.seed.empty() && is_large(options, grid.voxels()), "segment_slices", "voxels",
          grid.voxels(), "must be those of a large image, segmented without a mask and a seed");
  SegmentReport found;
  found.options = choose_settings(options, grid.voxels());
  SlabComponents components(grid.size[0], grid.size[1]);
  std::vector<std::uint8_t> labels;
  const auto pass_on = [&](Index begin, std::span<const std::uint8_t> some, bool turned) {
    labels.assign(some.begin(), some.end());
    if (turned)
      for (std::uint8_t& label : labels) label = 1 - label;
    components.add(labels);
    take(begin, labels);
  };
  std::optional<LargePartition<Dim>> partition =
      find_large_partition<Dim>(image, grid, {}, large_options(grid, found.options, options.progress), {}, pass_on);
  if (!partition) return std::nullopt;
  const bool turned = partition->outside == 1;
  if (turned)
    for (float& c : partition->coefficients) c = -c;
  use_large(*partition, found.options);
  found.iterations = partition->iterations;
  found.converged = partition->converged;
  found.energy = std::move(partition->energy);
  found.components = components.count();
  found.noise = partition->noise;
  double voxel = 1;
  for (int a = 0; a < grid.dimension(); ++a) voxel *= grid.spacing[a];
  for (int label = 0; label < 2; ++label) {
    const auto k = static_cast<std::size_t>(turned ? 1 - label : label);
    found.regions.push_back({.label = label,
                             .voxels = partition->voxels[k],
                             .volume = static_cast<double>(partition->voxels[k]) * voxel,
                             .mean = partition->means[k],
                             .sd = partition->deviations[k]});
  }
  warn_of_empty(found.regions, found.warnings);
  return Segmentation<Dim>{
      {},
      level_set_fields(partition->lattice, {std::move(partition->coefficients)}, partition->blocks),
      std::move(found)};
}

#define CSRBF_INSTANTIATE(Dim)                                                                                    \
  template std::optional<Segmentation<Dim>> segment_slices<Dim>(SliceSource&, const Grid&, const SegmentOptions&, \
                                                                const LabelsOfSlices&);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
