#include "csrbf/levelset/lattice/tap_sums.hpp"

#include "csrbf/core/lanes.hpp"

namespace csrbf {
namespace {

struct SumBlocks {
  // Four accumulators share each broadcast weight and hide the latency of their sums.
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(const Tap* taps, Index count, const float* in, Index n, float* out, bool add) {
    using Floats = Lanes<float, 16, Bytes>;
    constexpr Index width = Floats::size, block = 4 * width;
    static_assert(block == tap_slack);
    for (Index i = 0; i < n; i += block) {
      Floats a(0.0F), b(0.0F), c(0.0F), d(0.0F);
      if (add) {
        a = Floats(out + i);
        b = Floats(out + i + width);
        c = Floats(out + i + 2 * width);
        d = Floats(out + i + 3 * width);
      }
      for (Index t = 0; t < count; ++t) {
        const float* from = in + i + taps[t].offset;
        const float w = taps[t].weight;
        a += w * Floats(from);
        b += w * Floats(from + width);
        c += w * Floats(from + 2 * width);
        d += w * Floats(from + 3 * width);
      }
      a.store(out + i);
      b.store(out + i + width);
      c.store(out + i + 2 * width);
      d.store(out + i + 3 * width);
    }
  }
};

}  // namespace

void sum_taps(std::span<const Tap> taps, const float* in, Index n, float* out, bool add) {
  simd_call<SumBlocks>(taps.data(), static_cast<Index>(taps.size()), in, n, out, add);
}

}  // namespace csrbf
