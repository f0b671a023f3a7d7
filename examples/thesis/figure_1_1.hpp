#pragma once

#include "figure.hpp"

namespace csrbf::thesis {

/// Figs. 1.1 and 6.2: overlapping patches, their local functions and the sum.
Figure figure_1_1();

/// Fig. 1.2: an interpolant as the sum of its basis functions.
Figure figure_1_2();

}  // namespace csrbf::thesis
