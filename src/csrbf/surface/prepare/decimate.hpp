#pragma once

#include "csrbf/surface/composite/composite.hpp"

namespace csrbf {

/// One sample for up to four that follow each other in Morton order on one sheet: the one nearest to their mean, with
/// their mean normal, standing for their common area. Keeps the order. O(n).
OrientedPoints decimate(const OrientedPoints& cloud);

}  // namespace csrbf
