#pragma once

#include "csrbf/levelset/contour/variational.hpp"
#include "csrbf/levelset/lattice/lattice.hpp"
#include "csrbf/levelset/partition/partition.hpp"

#include <functional>

namespace csrbf {

/// What labels on a lattice may cost more than those found, of the price of their contours; by hand: larger loses
/// corners, smaller needs centres at every voxel.
inline constexpr double contour_tolerance = 0.05;

/// Level sets of a partition, whose labels they replace by their own.
template <int Dim>
struct PartitionContours {
  Lattice<Dim> lattice;
  double spacing;                                ///< of the centres, in voxels
  std::vector<std::vector<float>> coefficients;  ///< as of label_contours()
  double force = 0;                              ///< mean size of those on voxels, of two regions
};

/// Writes the contours of a partition in CSRBFs on the coarsest lattice, of center spacings 4, 3, 2 and 1 voxels, whose
/// labels cost at most a few percent of the contour more than those found, so that centres are as dense as the smallest
/// objects ask for; on the lattice of `given.center_spacing` when `spacing_is_given`.
template <int Dim>
PartitionContours<Dim> partition_contours(PartitionPrice& price, Partition& partition, int regions,
                                          const LatticeOptions& given, bool spacing_is_given);

/// What labels cost, in nats, and those of level sets at most; of two regions the cost of each voxel inside minus that
/// outside.
struct ContourPrice {
  std::function<double(std::span<const std::uint8_t>)> price;
  double most = 0;
  std::span<const float> force;
};

/// The same for any labels.
template <int Dim>
PartitionContours<Dim> write_contours(const Grid& grid, std::vector<std::uint8_t>& labels, int regions,
                                      const ContourPrice& judge, const LatticeOptions& given, bool spacing_is_given);

/// Voxels that a contour may lie off; by hand: one that is farther off, all around, has too few centres.
inline constexpr double level_tolerance = 0.2;

/// Adds a constant to the level set of a lattice, so that the border between two regions lies where the image is
/// likeliest by means that a camera blurs, whatever the contour costs: a short contour lies inside what is convex, in
/// space by twice as much as in the plane, and one on few centres does, too. The constant is one number for the whole
/// contour, so the noise hardly moves it. In the plane little is gained. Returns how far the contour moved outwards, at
/// most a voxel; 0 where nothing is gained. O(voxels).
template <int Dim>
double place_contour_level(PartitionPrice& price, const PartitionModel& model, const Lattice<Dim>& lattice,
                           VariationalResult& contour);

}  // namespace csrbf
