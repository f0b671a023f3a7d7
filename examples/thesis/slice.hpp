#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "figure.hpp"

#include <optional>
#include <string>
#include <vector>

namespace csrbf::thesis {

/// A grey picture, x fastest; pixels are points at integer coordinates.
struct Slice {
  Index width = 0;
  Index height = 0;
  Eigen::VectorXd values = {};

  [[nodiscard]] Points<2> pixels() const;
};

/// Where Debian's package mricron-data keeps a magnetic resonance image of a head.
extern const std::string brain_file;

/// The middle sagittal slice of brain_file, without its lowest row: 217 x 180 = 39,060 pixels, as many as Fig. 3.13
/// has. Empty when the file is not there.
std::optional<Slice> brain_slice();

/// A drawing of a head by ellipses with soft edges, for where there is no brain_file.
Slice drawn_slice(Index width, Index height);

/// Random pixels of a slice.
struct SampledSlice {
  Slice slice;
  std::vector<Index> ids;  ///< of the pixels that are samples, ascending
  Samples<2> samples;

  [[nodiscard]] double range() const { return slice.values.maxCoeff() - slice.values.minCoeff(); }
};

SampledSlice sample_slice(const Slice& slice, double share, unsigned seed);

/// Thesis eqs. (3.10) and (3.11): relative errors over all pixels and over the samples.
struct SliceErrors {
  double all = 0;
  double samples = 0;
};

SliceErrors slice_errors(const SampledSlice& sampled, const Eigen::VectorXd& reconstructed);

/// The figure with what says that the slice is missing.
Figure without_brain(Figure figure);

}  // namespace csrbf::thesis
