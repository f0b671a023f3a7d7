#pragma once

#include "csrbf/core/image.hpp"
#include "csrbf/implicit/contour_lines.hpp"

namespace csrbf {

using RgbColor = std::array<std::uint8_t, 3>;

struct Stroke {
  RgbColor color{255, 64, 64};
  double width = 1.5;  ///< pixels, positive
};

/// Draws lines onto a picture, antialiased. Coordinates are in pixels: the picture extends from (0, 0), its top left
/// corner, to (width, height); lines are clipped to it. Throws InvalidInput unless the width of the stroke is positive
/// and finite. O(pixels + length of the lines).
void draw_contour(const ContourLines& contours, const Stroke& stroke, RgbImage& picture);

}  // namespace csrbf
