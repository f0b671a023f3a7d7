#pragma once

#include "csrbf/levelset/partition/large_partition.hpp"
#include "csrbf/levelset/segment.hpp"

namespace csrbf {

/// segment() of an image for which is_large() holds, some slices at a time: the labels go to `take`, and those of the
/// result are empty. Nothing where the noise is too much for that (find_large_partition()); before `take` is called. No
/// mask, no seed. Memory: 0.3 GB, more where slices have more than 32 million voxels. Throws InvalidInput as segment()
/// does, also for values that are not finite.
template <int Dim>
std::optional<Segmentation<Dim>> segment_slices(SliceSource& image, const Grid& grid, const SegmentOptions& options,
                                                const LabelsOfSlices& take);

}  // namespace csrbf
