#pragma once

#include "csrbf/core/types.hpp"

#include <span>

namespace csrbf {

/// One term of a stencil: weight times the value `offset` entries further on.
struct Tap {
  Index offset;
  float weight;
};

/// out[i] = sum over taps of weight * in[i + offset], i < n; added to what out holds when `add`. Arrays must not
/// overlap, and both must have `tap_slack` readable (out: writable) entries behind their last used one.
void sum_taps(std::span<const Tap> taps, const float* in, Index n, float* out, bool add);

inline constexpr Index tap_slack = 64;  ///< floats that are summed at a time

}  // namespace csrbf
