#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// Directions to the sky and to points of the key light, spread over the 8 x 8 neighbouring samples of a picture: each
/// sample has one of 64 classes, and any 8 x 8 samples together have all of them, so that an average over such a square
/// is free of noise (interleaved sampling; Keller, Heidrich 2001). Sobol's sequence in the order of a Morton curve
/// makes the classes of smaller squares complement each other too.
class LightPattern {
 public:
  static constexpr int side = 8;  ///< samples; chosen by hand. Larger: less noise, wider blur
  static constexpr int classes = side * side;

  /// Local frame: z is the surface normal or the direction to the light.
  struct SkyRay {
    Point<3> direction;  ///< density proportional to the cosine with z
    double reach;        ///< in [1/4, 1], fraction of the largest distance at which surfaces occlude
  };

  /// Needs rays_per_sample >= 0.
  explicit LightPattern(int rays_per_sample);

  [[nodiscard]] int rays_per_sample() const { return rays_per_sample_; }

  /// Class of the sample in column x and row y of the picture, which may be negative.
  [[nodiscard]] static int class_of(int x, int y) {
    int light_class = 0;
    for (int bit = 1; bit < side; bit *= 2) light_class |= ((x & bit) | ((y & bit) << 1)) * bit;
    return light_class;
  }

  [[nodiscard]] const SkyRay& sky(int light_class, int ray) const { return sky_[light_class * rays_per_sample_ + ray]; }
  /// Point of the unit disk.
  [[nodiscard]] const Point<2>& lamp(int light_class) const { return lamp_[light_class]; }

 private:
  int rays_per_sample_;
  std::vector<SkyRay> sky_;
  std::array<Point<2>, classes> lamp_;
};

}  // namespace csrbf
