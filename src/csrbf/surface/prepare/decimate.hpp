#pragma once

#include "csrbf/surface/composite/composite.hpp"

namespace csrbf {

/// Replaces up to four consecutive samples in Morton order on one sheet by the one nearest to their mean, with their
/// mean normal and total area. Keeps the order. O(n).
OrientedPoints decimate(const OrientedPoints& cloud);

}  // namespace csrbf
