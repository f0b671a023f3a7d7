#pragma once

#include "csrbf/core/mesh.hpp"

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

/// Points of uniform density on the surface of a mesh.
struct SurfaceSamples {
  Points<3> points;                    ///< 3 x n
  Points<3> normals;                   ///< 3 x n, of the triangles by the right-hand rule
  std::vector<std::int32_t> triangle;  ///< n
};

/// Draws n points uniformly by area, stratified: sample i lies in the i-th of n equal parts of the area in triangle
/// order, so that neighbours in a coherent mesh are neighbours among the samples and averages converge faster than with
/// independent samples. Depends only on the mesh, n and seed. Throws InvalidInput if the mesh has no area.
/// O(t + n log t).
SurfaceSamples sample_surface(const Mesh& mesh, Index n, std::uint64_t seed = 7);

}  // namespace csrbf
