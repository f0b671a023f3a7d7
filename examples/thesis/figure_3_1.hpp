#pragma once

#include "figure.hpp"

namespace csrbf::thesis {

/// Figs. 3.1 and 3.2: clusters by principal components, and the supports of their centroids.
Figure figure_3_1();

}  // namespace csrbf::thesis
