#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// 8-bit RGB image, rows from top to bottom, three bytes per pixel.
struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;  ///< 3 * width * height

  RgbImage() = default;
  RgbImage(int w, int h) : width(w), height(h), pixels(static_cast<std::size_t>(Index{3} * w * h)) {}
};

}  // namespace csrbf
