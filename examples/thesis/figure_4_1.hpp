#pragma once

#include "figure.hpp"

namespace csrbf::thesis {

/// Figs. 3.18 and 4.1: contours drawn on the slices of a heart, and the implicit function through them.
Figure figure_4_1();

}  // namespace csrbf::thesis
