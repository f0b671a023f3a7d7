#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// Which part of work in tiles a process does, when several share a folder.
struct TileShare {
  Index rank = 0;   ///< of this process, from 0
  Index count = 1;  ///< processes; each must be started
};

}  // namespace csrbf
