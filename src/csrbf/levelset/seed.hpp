#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"

#include <vector>

namespace csrbf {

/// Voxels from which a segmentation starts (SegmentOptions::seed): 1 where the centre of the voxel is inside, 0
/// elsewhere; all 0 when nothing of the image is inside. Shapes are in the physical coordinates of the image
/// (Grid::to_physical), of which images of two axes have the first two. Throw InvalidInput when the grid has more than
/// Dim dimensions, and for the shapes below. O(voxels).
using Seed = std::vector<std::uint8_t>;

/// A disc or ball; at least the voxel at its centre. The radius must be positive and all numbers finite.
template <int Dim>
Seed seed_ball(const Grid& grid, const Point<Dim>& center, double radius);

/// A box along the physical axes; it must not be empty.
template <int Dim>
Seed seed_box(const Grid& grid, const Box<Dim>& box);

/// The polygon with these corners, at least three, joined in the order of their angles about their mean.
Seed seed_polygon(const Grid& grid, const Points<2>& corners);

/// Where the field is positive. One value per voxel.
template <int Dim>
Seed seed_inside(const Grid& grid, const Field<Dim>& field);

}  // namespace csrbf
