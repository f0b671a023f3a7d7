#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"

#include <vector>

namespace csrbf {

/// Where a segmentation starts (SegmentOptions::seed): 1 for voxels whose centre is inside, 0 for others; all 0 if
/// nothing in the image is inside. Shapes are in the physical coordinates of the image (Grid::to_physical); 2D images
/// have the first two. All functions below throw InvalidInput if the grid has more than Dim dimensions, or as stated.
/// O(voxels).
using Seed = std::vector<std::uint8_t>;

/// A disc or ball, at least the voxel at its centre. Throws InvalidInput unless all numbers are finite and the radius
/// is positive.
template <int Dim>
Seed seed_ball(const Grid& grid, const Point<Dim>& center, double radius);

/// A box along the physical axes. Throws InvalidInput if it is empty.
template <int Dim>
Seed seed_box(const Grid& grid, const Box<Dim>& box);

/// The polygon with these corners, joined in the order of their angles about their mean. Throws InvalidInput for fewer
/// than three corners.
Seed seed_polygon(const Grid& grid, const Points<2>& corners);

/// Where the field is positive.
template <int Dim>
Seed seed_inside(const Grid& grid, const Field<Dim>& field);

}  // namespace csrbf
