#pragma once

#include "csrbf/surface/composite/composite.hpp"

namespace csrbf {

/// Options of the composite fit and their cross-validation error.
struct ChosenOptions {
  CompositeOptions options;
  /// Mean distance of samples from the patches fitted without them; unit of the cloud.
  double cross_validation_error = 0;
};

/// Least number of patches of a body. Chosen by hand; larger: patches stay small beside thin bodies, smaller: less
/// averaging of noise.
inline constexpr Index leaves_of_body = 20;

/// Options that are already fixed.
struct GivenOptions {
  std::optional<double> smoothing;
  std::optional<Index> leaf_size;
  NormalRows normal_rows = NormalRows::gradient;
  /// Number of samples of a body if the cloud consists of several: patches must be small compared with it. Default:
  /// the size of the cloud.
  std::optional<Index> body_size = {};
  /// Where the surface is wanted, if not everywhere: samples outside are not predicted.
  std::optional<Box<3>> region = {};
};

/// Chooses patch size, weight of the normals, number of CSRBF centres and smoothing by leave-one-out cross-validation
/// of some ten thousand samples in blocks all over the cloud. Noise calls for large patches, detail for small ones;
/// among choices that do not differ significantly the smoothest wins under noise, else the one closest to the samples.
/// Under clear noise each place then chooses its own leaves around that size (CompositeOptions::choose_leaves).
/// Time does not depend on n.
ChosenOptions choose_options(const OrientedPoints& cloud, const KdTree<3>& tree, const GivenOptions& given = {});

}  // namespace csrbf
