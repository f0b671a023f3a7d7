#pragma once

#include "figure.hpp"

namespace csrbf::thesis {

/// Fig. 6.1: interpolation and approximation of noisy data.
Figure figure_6_1();

/// Fig. 6.3: the decay functions of the weights, and how smoothly they end.
Figure figure_6_3();

}  // namespace csrbf::thesis
