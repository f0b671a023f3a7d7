#pragma once

#include "figure.hpp"

namespace csrbf::thesis {

/// Figs. 1 and 3 of the introduction of Part II: where samples may lie.
Figure introduction();

}  // namespace csrbf::thesis
