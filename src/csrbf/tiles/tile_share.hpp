#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// Which part of the work in tiles a process does, if several share a folder.
struct TileShare {
  Index rank = 0;   ///< number of this process, from 0
  Index count = 1;  ///< number of processes; you start each of them
};

}  // namespace csrbf
