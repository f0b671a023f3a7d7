#pragma once

#include "csrbf/core/types.hpp"

#include <string>

namespace csrbf {

/// The local functions of a partition of unity: polynomials of a degree plus CSRBF sums.
struct LocalOptions {
  std::string kernel = "wendland-c4";
  double support = 4;  ///< of the kernel, in units of the radius of a patch
  int degree = 2;      ///< -1: no polynomial
  Index samples = 40;  ///< a patch is fitted to this many samples
  Index centers = 40;  ///< radial functions per patch, centred at samples spread over it; `samples`: at all of them
  /// 0: distances are Euclidean. Up to 1: those across the direction in which the samples of a patch lie, as on a track
  /// of soundings, are stretched, for 1 until the samples spread evenly. For radial functions only.
  double anisotropy = 0;
  double smoothing = 0;  ///< lambda: sum_k w_k (f - s)^2 + lambda alpha^T A alpha is minimised

  bool operator==(const LocalOptions&) const = default;
};

}  // namespace csrbf
