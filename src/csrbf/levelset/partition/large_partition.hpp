#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/levelset/convex/convex_contour.hpp"
#include "csrbf/levelset/image/slice_source.hpp"
#include "csrbf/levelset/lattice/lattice.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace csrbf {

/// Two regions of constant means of an image that is too large for find_partition().
template <int Dim>
struct LargePartition {
  Grid blocks;  ///< of the lattice
  Lattice<Dim> lattice;
  std::vector<float> coefficients;  ///< of the level set that is positive where labels are 1
  std::vector<double> energy;       ///< after each round, in nats per voxel
  int outside = 0;                  ///< the label that most of the border of the image has
  std::array<Index, 2> voxels{0, 0};
  std::array<double, 2> means{0, 0}, deviations{0, 0};
  int iterations = 0;
  bool converged = false;
  double smoothness = 0;  ///< weight of the length over the mean force
  double noise = 0;       ///< deviation of the voxels over the contrast
  double spacing = 0;     ///< of the centres, in voxels of the shortest edge
};

struct LargePartitionOptions {
  ContourWeight weight;  ///< price of a contour, in nats
  double support = 0;    ///< of the lattice, in spacings of its centres
  std::string kernel;
  Index slab_voxels = 1 << 24;  ///< of the slices that are read at once, at least one; by hand: 100 MB
  Progress progress = {};
};

/// Takes the labels of the slices from `begin` on.
using LabelsOfSlices = std::function<void(Index begin, std::span<const std::uint8_t> labels)>;

/// The same while it is known which label is outside.
using LabelsFound = std::function<void(Index begin, std::span<const std::uint8_t> labels, bool outside_is_1)>;

/// Two means with equal deviations and what each voxel is nearer to, in turns. A voxel whose likelihood says less than
/// the contour of a single voxel would cost takes the side of the mean of its neighbours (a Gaussian of 0.7 voxels).
/// The means start from two classes of the means of small blocks. Then a level set on blocks of voxels, at most 2
/// million of them, with a centre in each, is fitted to the shares of the regions in the blocks.
///
/// The image is read a slab of slices at a time, about six times in all. `labels`: of the whole image, to be filled; or
/// empty, and `take` gets them slice by slice in the end. Both are the same.
///
/// No result where the deviation is more than 0.3 of the contrast. `mask`: 0 in voxels that do not count; may be empty.
/// About 30 ns per voxel.
template <int Dim>
std::optional<LargePartition<Dim>> find_large_partition(SliceSource& image, const Grid& grid,
                                                        std::span<const std::uint8_t> mask,
                                                        const LargePartitionOptions& options,
                                                        std::span<std::uint8_t> labels, const LabelsFound& take);

}  // namespace csrbf
