#pragma once

#include <cstdint>

namespace csrbf {

/// Mixes 64 bits so that each input bit changes every output bit with probability about 1/2 (the finalizer of
/// SplitMix64; Steele, Lea, Flood 2014).
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

/// Uniform number in [0, 1) that depends on (seed, counter, dimension) only: random access for parallel loops.
constexpr double hash_uniform(std::uint64_t seed, std::uint64_t counter, std::uint64_t dimension) {
  return static_cast<double>(mix_bits(mix_bits(mix_bits(seed) ^ counter) + dimension) >> 11) * 0x1p-53;
}

}  // namespace csrbf
