#pragma once

#include "figure.hpp"

namespace csrbf::thesis {

/// Fig. 6.9: Voronoi diagram, Delaunay triangulation and poles of samples of a curve.
Figure figure_6_9();

}  // namespace csrbf::thesis
