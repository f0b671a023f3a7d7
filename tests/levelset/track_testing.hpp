#pragma once

#include "csrbf/core/grid.hpp"
#include "levelset/segment_testing.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace csrbf::track_testing {

using std::numbers::pi;

inline constexpr Index n = 96;

struct Disc {
  double x = 0, y = 0, radius = 24;
};

// Discs on n x n pixels, one per frame: 40 outside, 210 inside, edges one pixel wide.
inline Volume<float> disc_sequence(const std::vector<Disc>& discs, double noise, unsigned seed = 1) {
  Volume<float> sequence;
  for (std::size_t t = 0; t < discs.size(); ++t) {
    const Disc& disc = discs[t];
    const Phantom frame = make_phantom(
        n, [&](double x, double y) { return disc.radius - std::hypot(x - disc.x, y - disc.y); }, 1, noise,
        seed + 100 * static_cast<unsigned>(t));
    if (t == 0) static_cast<VolumeLayout&>(sequence) = frame.image;
    sequence.values.insert(sequence.values.end(), frame.image.values.begin(), frame.image.values.end());
  }
  sequence.frames = static_cast<Index>(discs.size());
  return sequence;
}

inline std::vector<std::uint8_t> disc_labels(const Disc& disc) {
  return disc_seed(n, disc.x, disc.y, disc.radius);
}

inline std::vector<Disc> beat(int frames) {
  std::vector<Disc> discs;
  for (int t = 0; t < frames; ++t) {
    const double phase = 2 * pi * t / frames;
    discs.push_back({3 * std::sin(phase), 2 * std::cos(phase), 24 + 6 * std::cos(phase)});
  }
  return discs;
}

}  // namespace csrbf::track_testing
