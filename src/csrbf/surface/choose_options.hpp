#pragma once

#include "csrbf/surface/composite.hpp"

#include <optional>

namespace csrbf {

/// Options of the composite fit and what speaks for them.
struct ChosenOptions {
  CompositeOptions options;
  /// Mean distance of left-out samples to the patches fitted without them; unit of the cloud.
  double cross_validation_error = 0;
};

/// What is decided already.
struct GivenOptions {
  std::optional<double> smoothing;
  std::optional<Index> leaf_size;
  NormalRows normal_rows = NormalRows::gradient;
};

/// Chooses patch size, weight of the normals, number of CSRBF centres and smoothing by cross-validation: every tenth
/// sample is left out, and a few hundred patches fitted to the others predict it. Noise asks for large patches, detail
/// for small ones; of choices that cannot be told apart the smoother one wins. O(n) with a small factor.
ChosenOptions choose_options(const OrientedPoints& cloud, const GivenOptions& given = {});

}  // namespace csrbf
