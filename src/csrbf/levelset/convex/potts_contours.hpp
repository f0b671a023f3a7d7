#pragma once

#include "csrbf/levelset/convex/convex_contour.hpp"

namespace csrbf {

/// Minimises sum_k (sum cost_k u_k + 1/2 contour_price(u_k)) over u_k >= 0 with sum_k u_k = 1 at every voxel, and
/// labels each voxel with the largest u_k: the relaxation of Potts' model (Zach et al. 2008), by the primal-dual method
/// of Chambolle and Pock 2011 from the labels given. `costs`: one array per label. 28 bytes and about 2 ns per
/// iteration for each voxel and label; the same bits for any number of threads. Returns the number of iterations.
int potts_contours(const std::array<Index, 3>& size, const ContourWeight& weight,
                   const std::vector<std::vector<float>>& costs, std::span<std::uint8_t> labels);

}  // namespace csrbf
