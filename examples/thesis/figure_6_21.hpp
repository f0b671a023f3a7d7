#pragma once

#include "surfaces.hpp"

namespace csrbf::thesis {

/// Condition numbers of B^T B + mu D^T D (6.32) of a cloud with a budget of centres, for several mu.
std::vector<double> conditions(const PointCloud& cloud, Index centers, const std::vector<double>& weights);

/// Figs. 6.21 to 6.23.
Figure figure_6_21();

}  // namespace csrbf::thesis
