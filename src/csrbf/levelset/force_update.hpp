#pragma once

#include <functional>

namespace csrbf {

/// Given the labels of all voxels (1 inside, 0 outside), writes what it costs to have each voxel inside instead of
/// outside: negative where it wants to be inside. A level set f follows f_t = -force delta(f).
using ForceUpdate = std::function<void(const unsigned char* labels, float* force)>;

}  // namespace csrbf
