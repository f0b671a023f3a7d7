#pragma once

#include "surfaces.hpp"

namespace csrbf::thesis {

/// Root mean square Taubin distances of the points without noise to surfaces of the points with noise, of the composite
/// method with `centers` centres: with the weight that cross-validation chooses first, then with the given ones.
std::vector<double> smoothing_errors(const PointCloud& clean, const PointCloud& noisy, Index centers,
                                     const std::vector<double>& weights);

/// Fig. 6.8.
Figure figure_6_8();

}  // namespace csrbf::thesis
