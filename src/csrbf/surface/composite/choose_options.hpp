#pragma once

#include "csrbf/surface/composite/composite.hpp"

#include <optional>

namespace csrbf {

/// Options of the composite fit and what speaks for them.
struct ChosenOptions {
  CompositeOptions options;
  /// Mean distance of samples to the patches fitted without them; unit of the cloud.
  double cross_validation_error = 0;
};

inline constexpr Index leaves_of_body = 20;  ///< least number of patches that make up a body

/// What is decided already.
struct GivenOptions {
  std::optional<double> smoothing;
  std::optional<Index> leaf_size;
  NormalRows normal_rows = NormalRows::gradient;
  /// Samples of a body, where the cloud consists of several: patches are to be small beside it. Default: of the cloud.
  std::optional<Index> body_size = {};
};

/// Chooses patch size, weight of the normals, number of CSRBF centres and smoothing by leave-one-out cross-validation
/// of some ten thousand samples in blocks all over the cloud. Noise asks for large patches, detail for small ones; of
/// choices that cannot be told apart the smoother one wins under noise, else the one closer to the samples. Time does
/// not depend on n.
ChosenOptions choose_options(const OrientedPoints& cloud, const KdTree<3>& tree, const GivenOptions& given = {});

/// The same with a tree of its own: O(n log n).
ChosenOptions choose_options(const OrientedPoints& cloud, const GivenOptions& given = {});

}  // namespace csrbf
