#pragma once

#include "figure.hpp"

namespace csrbf::thesis {

/// Tables 2.1 to 2.3 and Figs. 2.1 to 2.3: the kernels, and whether they are positive definite.
Figure figure_2_1();

}  // namespace csrbf::thesis
