#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"
#include "csrbf/levelset/segment_options.hpp"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace csrbf {

/// What was done, and with which settings.
struct SegmentReport {
  SegmentSettings options;  ///< with the values used in place of `automatic`
  int iterations = 0;
  bool converged = false;  ///< labels had stopped changing
  /// After each step, per voxel, in units of the mean cost of a voxel in the wrong region. Never increases with the
  /// variational method. In speckle the last steps follow its own law.
  std::vector<double> energy;
  std::vector<RegionReport> regions;
  Index components = 0;  ///< connected parts (by faces) of all regions but 0
  double noise = 0;      ///< standard deviation of the noise of the energies over their contrast
  /// Set when the noise of the image changes with intensity and the energy is `automatic`: its deviation where the
  /// image is bright over that where it is dark.
  std::optional<double> noise_growth = {};
  /// Set when it varies over the place instead: its largest deviation over the least.
  std::optional<double> uneven_noise = {};
  /// Set when waves that cover the image were left out, as fringes and meshes are: how many.
  std::optional<Index> fringes = {};
  /// Set when the noise is blurred and the energy is `automatic`: voxels that one independent value covers.
  std::optional<double> grain = {};
  /// Set when the image is speckle: the power of the amplitudes that it shows; about 0: their logarithms.
  std::optional<double> speckle = {};
  /// Set when more than two regions are classes of the image after a Gaussian: its deviation, in voxels of the shortest
  /// edge.
  std::optional<double> blur = {};
  /// Set when the image has impulses, dead and hot voxels, and the energy is `automatic`: their share.
  std::optional<double> impulses = {};
  /// Set when voxels in the mask are missing: their share. options.missing has the value of a block that was found.
  std::optional<double> missing = {};
  /// Set when two regions are textures: the share of the variance of labels 0 and 1 that neighbouring voxels tell.
  std::optional<std::array<double, 2>> textures = {};
  std::vector<EnergyPrice> prices;  ///< of the energy `automatic`: one for each model
  std::vector<double> channels;     ///< of an image with components: the weights of their sum, which was segmented
  std::vector<std::string> warnings;
};

template <int Dim>
struct Segmentation {
  std::vector<std::uint8_t> labels;  ///< x fastest; 0 = outside
  /// The level set of region 1 (two regions), or one of each region: f > 0 inside it, about the signed distance close
  /// to its boundary, in physical coordinates of the grid.
  std::vector<std::shared_ptr<const Field<Dim>>> fields;
  SegmentReport report;
};

}  // namespace csrbf
