#pragma once

#include "csrbf/levelset/contour/variational.hpp"
#include "csrbf/levelset/lattice/lattice.hpp"
#include "csrbf/levelset/partition/partition_model.hpp"

namespace csrbf {

/// Voxels that a contour may lie off; by hand: one that is farther off, all around, has too few centres.
inline constexpr double level_tolerance = 0.2;

/// Adds a constant to the level set of a lattice, so that the border between two regions lies where the image is
/// likeliest by means that a camera blurs, whatever the contour costs: a short contour lies inside what is convex, in
/// space by twice as much as in the plane, and one on few centres does, too. The constant is one number for the whole
/// contour, so the noise hardly moves it. Returns how far the contour moved outwards, at most a voxel; 0 where nothing
/// is gained. O(voxels).
template <int Dim>
double place_contour_level(PartitionPrice& price, const PartitionModel& model, const Lattice<Dim>& lattice,
                           VariationalResult& contour);

}  // namespace csrbf
