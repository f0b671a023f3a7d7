#pragma once

#include "csrbf/levelset/regions/force_source.hpp"
#include "csrbf/levelset/segment_options.hpp"

namespace csrbf {

/// The forces of a source, for the methods that the variational one is compared with. Appends the energy of the labels
/// that they are asked for, as in SegmentReport. Source and energy must outlive the result.
ForceUpdate baseline_forces(ForceSource& source, std::size_t voxels, std::vector<double>& energy);

}  // namespace csrbf
