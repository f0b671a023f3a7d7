#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"
#include "csrbf/core/image.hpp"
#include "csrbf/implicit/curves/draw_contour.hpp"

#include <vector>

namespace csrbf {

struct PreviewOptions {
  /// The axis across which the image is cut: 0, 1 or 2. Only images of three axes are cut at all.
  int axis = 2;

  /// Number of the slice along this axis; -1: the one with the largest area inside any of the fields.
  Index slice = -1;

  Index frame = 0;

  /// Pixels along the longest side, at least: voxels are enlarged by the smallest whole factor that reaches them (by
  /// the spacing of the other axis where it is wider); 1 ... 16384.
  int size = 512;

  /// Shares of the voxels of the slice that become black below and white above.
  std::array<double, 2> window{0.01, 0.99};

  /// The contours f = level are drawn.
  double level = 0;

  double line_width = 1.5;  ///< pixels

  /// Of the contours, repeated when there are more fields. Default: red, yellow, blue, green, magenta, white.
  std::vector<RgbColor> colors{};
};

/// Picture of an image, or of a slice of it, with the contours of fields drawn on it. The fields are functions of the
/// physical coordinates of the image (Grid::to_physical). Values are grey between the ends of the window; images with
/// three components or more are coloured; missing values are black.
///
/// Columns and rows are those of the slice, with the first row on top; z goes upwards. Images in the space of patients
/// are shown as radiologists see them: the patient's left is on the right, the front on top or on the left.
///
/// Throws InvalidInput when there is no such slice, axis or frame, for a size or window outside the above, and when the
/// image has three axes and Dim is 2.
template <int Dim>
RgbImage preview(const Volume<float>& image, const std::vector<const Field<Dim>*>& fields,
                 const PreviewOptions& options = {});

/// The slice across an axis that has the largest area inside any of the fields: f >= level at 64 x 64 points of
/// each; the middle one when nothing is inside.
template <int Dim>
Index largest_slice(const Grid& grid, const std::vector<const Field<Dim>*>& fields, int axis, double level = 0);

}  // namespace csrbf
