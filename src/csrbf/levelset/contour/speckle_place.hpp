#pragma once

#include "csrbf/levelset/lattice/lattice.hpp"

#include <optional>

namespace csrbf {

/// A level set whose contour lies where the blur of speckle says.
template <int Dim>
struct SpecklePlace {
  Lattice<Dim> lattice;
  double spacing;  ///< of its centres, in voxels
  std::vector<float> coefficients;
  std::vector<std::uint8_t> labels;
  double exponent;            ///< SpeckleModel::exponent
  std::vector<double> steps;  ///< of the energy of SpeckleContour
};

/// Moves the contour of a level set with these labels, of two regions, if the image is speckle. `mask` and `prior` as
/// in SegmentOptions. The centres are at least as far apart as the grain asks for, unless `keeps_centers`.
template <int Dim>
std::optional<SpecklePlace<Dim>> find_speckle_place(std::span<const float> values, const Grid& grid,
                                                    std::span<const std::uint8_t> mask, std::span<const float> prior,
                                                    const LatticeOptions& centers, bool keeps_centers,
                                                    const std::vector<std::uint8_t>& labels,
                                                    const std::vector<float>& coefficients);

}  // namespace csrbf
