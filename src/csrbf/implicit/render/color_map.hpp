#pragma once

#include <Eigen/Core>

namespace csrbf {

/// Red, green and blue of linear light (linear sRGB), each in [0, 1].
using LinearRgb = Eigen::Vector3f;

/// Linear light from an sRGB component in [0, 1] and back (IEC 61966-2-1).
float linear_from_srgb(float encoded);
float srgb_from_linear(float linear);

/// From dark blue through green to light yellow for t from 0 to 1 (clamped): lightness increases uniformly, and hues
/// from blue to yellow are distinguishable with any red-green colour blindness.
LinearRgb sequential_color(double t);

/// From blue through near white to red for t from -1 to 1 (clamped); equal lightness at +t and -t.
LinearRgb diverging_color(double t);

}  // namespace csrbf
