#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// Half-line from `origin`; `direction` has length 1.
struct Ray {
  Point<3> origin = Point<3>::Zero();
  Point<3> direction = Point<3>::UnitX();
};

}  // namespace csrbf
