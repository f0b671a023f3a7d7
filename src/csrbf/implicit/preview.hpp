#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/implicit/draw_contour.hpp"

namespace csrbf {

struct PreviewOptions {
  /// The axis perpendicular to the slice: 0, 1 or 2. Only 3D images are sliced.
  int axis = 2;
  /// Index of the slice along this axis; -1: the one with the largest area inside any of the fields.
  Index slice = -1;
  Index frame = 0;
  /// Least number of pixels along the longest side: voxels are enlarged by the smallest integer factor that reaches it
  /// (anisotropic voxels in proportion to their spacings); 1 ... 16384.
  int size = 512;
  /// Quantiles of the voxels of the slice that are shown as black and white.
  std::array<double, 2> window{0.01, 0.99};

  /// The contours f = level are drawn.
  double level = 0;

  double line_width = 1.5;  ///< pixels

  /// Colours of the contours, repeated if there are more fields. Default: red, yellow, blue, green, magenta, white.
  std::vector<RgbColor> colors{};
};

/// Picture of an image, or of a slice of it, with the contours of fields drawn on it. The fields are functions of the
/// physical coordinates of the image (Grid::to_physical). Values within the window are shown in grey; images with
/// three or more components in colour; missing values in black.
///
/// Columns and rows are those of the slice, with the first row on top; z points upwards. Images in patient space are
/// shown in radiological convention: the patient's left is on the right, the front on top or on the left.
///
/// Throws InvalidInput if there is no such slice, axis or frame, for a size or window outside the above, and if the
/// image is 3D and Dim is 2.
template <int Dim>
RgbImage preview(const Volume<float>& image, const std::vector<const Field<Dim>*>& fields,
                 const PreviewOptions& options = {});

/// The slice perpendicular to an axis that has the largest area inside any of the fields: f >= level at 64 x 64 points
/// of each; the middle one if nothing is inside.
template <int Dim>
Index largest_slice(const Grid& grid, const std::vector<const Field<Dim>*>& fields, int axis, double level = 0);

}  // namespace csrbf
