#pragma once

#include "figure.hpp"
#include "level_sets.hpp"

#include <string>

namespace csrbf::thesis {

/// Collocation of `speckled_wall` with the forces (8.32) and the 600 nodes of the thesis, from a disc in the cavity.
SegmentedImage wall_run(const Phantom& wall, int iterations);

/// segment() of speckle with a law and a window of that half width, from a seed in the middle of the image.
SegmentedImage speckle_run(const Phantom& phantom, SegmentEnergy energy, int window);

/// Figs. 8.10 and 8.11. `ultrasound`: the name of an image file to segment too, or empty.
Figure figure_8_10(const std::string& ultrasound = {});

}  // namespace csrbf::thesis
