#pragma once

#include "csrbf/core/grid.hpp"

#include <vector>

namespace csrbf {

/// What a contour between voxels costs per step of the label along each axis: `length` along the axes of the shortest
/// edge, less along others, where a step is longer.
struct ContourWeight {
  double length = 1;                     ///< price of a contour, per shortest edge (2D) or its square (3D)
  std::array<double, 3> along{1, 1, 1};  ///< shortest edge over that along the axis; 0 along axes of one voxel
};

/// The weight of a grid; `length` > 0.
ContourWeight contour_weight(const Grid& grid, double length);

/// Price of the contour of the voxels with label `label`: sum of |D 1| over forward differences D, scaled. O(voxels).
double contour_price(std::span<const std::uint8_t> labels, std::uint8_t label, const std::array<Index, 3>& size,
                     const ContourWeight& weight);

/// The part of it of the first `slices` slices of these, which have neighbours in the next one.
double contour_price(std::span<const std::uint8_t> labels, std::uint8_t label, const std::array<Index, 3>& size,
                     const ContourWeight& weight, Index slices);

/// What one contour leaves for the next on the same grid to go on from; empty at first.
struct ContourState {
  std::vector<float> u;                     ///< of each voxel, in [0, 1]
  std::array<std::vector<float>, 3> duals;  ///< along the axes
  double at_rest = 2e-5;                    ///< mean change of u per iteration at the end; larger leaves specks
};

/// Minimises sum force u + contour_price(u) over 0 <= u <= 1 and labels 1 where u > 1/2: the global minimum over all
/// sets, up to how voxels measure lengths (Chan, Esedoglu and Nikolova 2006), by the primal-dual method of Chambolle
/// and Pock 2011 from the labels given. Voxels whose force exceeds what any contour could save keep its side and take
/// no part; nor do tiles of such voxels, so cost and memory are those of the voxels in doubt: 24 bytes and about 2 ns
/// per iteration for each. From the state of a similar force it takes a few iterations instead of many; it is
/// replaced. Where its u is on the other side than the label, the label counts. The result has the same bits for any
/// number of threads. Returns the number of iterations.
int convex_contour(const std::array<Index, 3>& size, const ContourWeight& weight, std::span<const float> force,
                   std::span<std::uint8_t> labels, ContourState* state = nullptr);

}  // namespace csrbf
