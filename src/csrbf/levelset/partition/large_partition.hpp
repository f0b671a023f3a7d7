#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/levelset/lattice/lattice.hpp"
#include "csrbf/levelset/partition/convex_contour.hpp"

#include <optional>
#include <vector>

namespace csrbf {

/// Two regions of constant means of an image that is too large for find_partition().
template <int Dim>
struct LargePartition {
  std::vector<std::uint8_t> labels;
  Grid blocks;  ///< of the lattice
  Lattice<Dim> lattice;
  std::vector<float> coefficients;  ///< of the level set that is positive where labels are 1
  std::vector<double> energy;       ///< after each round, in nats per voxel
  int iterations = 0;
  bool converged = false;
  double smoothness = 0;  ///< weight of the length over the mean force
  double noise = 0;       ///< deviation of the voxels over the contrast
  double spacing = 0;     ///< of the centres, in voxels of the shortest edge
};

/// Two means with equal deviations and what each voxel is nearer to, in turns. A voxel whose likelihood says less than
/// the contour of a single voxel would cost takes the side of the mean of its neighbours (a Gaussian of 0.7 voxels).
/// The means start from two classes of the means of small blocks. Nothing of the size of the image is held but the
/// labels. Then a level set on blocks of voxels, at most 2 million of them, with a centre in each, is fitted to the
/// shares of the regions in the blocks.
///
/// No result where the deviation is more than 0.3 of the contrast. `mask`: 0 in voxels that do not count; may be empty.
/// About 30 ns per voxel.
template <int Dim>
std::optional<LargePartition<Dim>> find_large_partition(std::span<const float> values, const Grid& grid,
                                                        std::span<const std::uint8_t> mask, const ContourWeight& weight,
                                                        double support, const std::string& kernel,
                                                        const Progress& progress);

}  // namespace csrbf
