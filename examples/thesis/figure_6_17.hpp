#pragma once

#include "surfaces.hpp"

namespace csrbf::thesis {

/// Fig. 6.5: the composite method with few centres.
Figure figure_6_5();

/// Figs. 6.14 to 6.17: more and more centres with supports adapted to the medial axis.
Figure figure_6_17();

}  // namespace csrbf::thesis
