#pragma once

#include "csrbf/core/lanes.hpp"
#include "csrbf/surface/composite/patches.hpp"

/// The kernel of the CSRBF residual of a patch, Wendland's C4 function phi_{3,2}, as a function of the squared distance
/// d2 in local coordinates: phi, g / sigma^2 and h / sigma^4 of kernels/kernel.hpp with sigma =
/// Patches::support. For loops that become SIMD code.
namespace csrbf::patch_kernel {

inline constexpr double inverse_support2 = 1.0 / (Patches::support * Patches::support);

CSRBF_ALWAYS_INLINE double value(double d2) {
  const double r2 = inverse_support2 * d2, r = std::sqrt(r2), a = std::max(0.0, 1 - r), a2 = a * a;
  return (1.0 / 3.0) * (a2 * a2 * a2) * (35 * r2 + 18 * r + 3);
}

/// phi and g, lane by lane.
template <class Numbers>
struct ValueAndSlope {
  Numbers value, slope;

  CSRBF_ALWAYS_INLINE explicit ValueAndSlope(const Numbers& d2) {
    const Numbers r2 = inverse_support2 * d2, r = sqrt(r2), rest = 1.0 - r;
    const Numbers a = choose(rest > 0.0, rest, Numbers(0.0)), a2 = a * a, a4 = a2 * a2;
    value = (1.0 / 3.0) * (a4 * a2) * (35.0 * r2 + (18.0 * r + 3.0));
    slope = (-(56.0 / 3.0) * inverse_support2) * (a4 * a) * (5.0 * r + 1.0);
  }
};

/// h, lane by lane.
template <class Numbers>
CSRBF_ALWAYS_INLINE Numbers bend(const Numbers& d2) {
  const Numbers rest = 1.0 - sqrt(inverse_support2 * d2);
  const Numbers a = choose(rest > 0.0, rest, Numbers(0.0)), a2 = a * a;
  return (560 * inverse_support2 * inverse_support2) * (a2 * a2);
}

}  // namespace csrbf::patch_kernel
