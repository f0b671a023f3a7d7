#pragma once

#include <functional>

namespace csrbf {

/// Given the labels of all voxels (1 inside, 0 outside), writes the cost of each voxel inside minus its cost outside:
/// negative where it belongs inside. A level set f follows f_t = -force delta(f).
using ForceUpdate = std::function<void(const unsigned char* labels, float* force)>;

}  // namespace csrbf
