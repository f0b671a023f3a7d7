#pragma once

#include "figure.hpp"

namespace csrbf::thesis {

/// Fig. 8.1: lattices of squares and of triangles.
Figure figure_8_1();

}  // namespace csrbf::thesis
