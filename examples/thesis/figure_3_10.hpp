#pragma once

#include "figure.hpp"

namespace csrbf::thesis {

/// Figs. 3.10 to 3.12: furthest points, their bounded Voronoi cells and supports.
Figure figure_3_10();

}  // namespace csrbf::thesis
