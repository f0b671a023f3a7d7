#pragma once

#include "figure.hpp"
#include "level_sets.hpp"

namespace csrbf::thesis {

/// The shape of Fig. 7.1 after that many steps of a narrow delta (7.12), from a contour around the whole object.
SegmentedImage active_contour(int steps);

/// Figs. 7.1 and 7.3.
Figure figure_7_1();

}  // namespace csrbf::thesis
