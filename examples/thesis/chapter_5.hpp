#pragma once

#include "figure.hpp"

namespace csrbf::thesis {

/// Chapter 5: earlier methods on one cloud; Figs. 5.2 and 5.3.
Figure chapter_5();

}  // namespace csrbf::thesis
