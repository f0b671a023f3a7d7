#pragma once

#include "csrbf/levelset/partition/large_partition.hpp"
#include "csrbf/levelset/segment.hpp"

namespace csrbf {

/// Whether segment() finds labels of single voxels and a level set on blocks of these: two regions, the energy
/// `automatic`, and more voxels than the choice among models can take.
bool is_large(const SegmentOptions& options, Index voxels);

/// segment() of an image for which is_large() holds, some slices at a time: the labels go to `take`, and those of the
/// result are empty. Nothing where the noise is too much for that (find_large_partition()); before `take` is called. No
/// mask, no seed. Memory: 0.3 GB, more where slices have more than 32 million voxels. Throws InvalidInput as segment()
/// does, also for values that are not finite.
template <int Dim>
std::optional<Segmentation<Dim>> segment_slices(SliceSource& image, const Grid& grid, const SegmentOptions& options,
                                                const LabelsOfSlices& take);

/// The options of find_large_partition(), and the settings that it chose.
LargePartitionOptions large_options(const Grid& grid, const SegmentSettings& settings, const Progress& progress);
template <int Dim>
void use_large(const LargePartition<Dim>& found, SegmentSettings& used);

}  // namespace csrbf
