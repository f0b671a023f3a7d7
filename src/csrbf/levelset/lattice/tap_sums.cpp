#include "csrbf/levelset/lattice/tap_sums.hpp"

#include "csrbf/core/simd.hpp"

#include <cstring>

namespace csrbf {
namespace {

// Sixteen floats: one AVX-512 register, two of AVX2.
using Wide = float __attribute__((vector_size(64)));
constexpr Index width = 16;
constexpr Index block = 4 * width;  // one per accumulator
static_assert(block == tap_slack);

// Four accumulators share each broadcast weight and hide the latency of their sums.
CSRBF_SIMD_CLONES
void sum_blocks(const Tap* taps, Index count, const float* in, Index n, float* out, bool add) {
  for (Index i = 0; i < n; i += block) {
    Wide a = {}, b = {}, c = {}, d = {};
    if (add) {
      std::memcpy(&a, out + i, sizeof a);
      std::memcpy(&b, out + i + width, sizeof b);
      std::memcpy(&c, out + i + 2 * width, sizeof c);
      std::memcpy(&d, out + i + 3 * width, sizeof d);
    }
    for (Index t = 0; t < count; ++t) {
      const float* from = in + i + taps[t].offset;
      const float w = taps[t].weight;
      Wide x, y, z, u;
      std::memcpy(&x, from, sizeof x);
      std::memcpy(&y, from + width, sizeof y);
      std::memcpy(&z, from + 2 * width, sizeof z);
      std::memcpy(&u, from + 3 * width, sizeof u);
      a += w * x;
      b += w * y;
      c += w * z;
      d += w * u;
    }
    std::memcpy(out + i, &a, sizeof a);
    std::memcpy(out + i + width, &b, sizeof b);
    std::memcpy(out + i + 2 * width, &c, sizeof c);
    std::memcpy(out + i + 3 * width, &d, sizeof d);
  }
}

}  // namespace

void sum_taps(std::span<const Tap> taps, const float* in, Index n, float* out, bool add) {
  sum_blocks(taps.data(), static_cast<Index>(taps.size()), in, n, out, add);
}

}  // namespace csrbf
