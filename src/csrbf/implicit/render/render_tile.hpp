#pragma once

#include "csrbf/core/image.hpp"
#include "csrbf/implicit/render/studio.hpp"

namespace csrbf {

/// Pixels [x_begin, x_end) x [y_begin, y_end).
struct Tile {
  int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// Renders one tile into the image on the calling thread. The pixels do not depend on how the picture is tiled.
void render_tile(const Studio& studio, const Tile& tile, RgbImage& image);

}  // namespace csrbf
