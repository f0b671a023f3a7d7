#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/implicit/draw_contour.hpp"

namespace csrbf {

struct PreviewOptions {
  /// The axis perpendicular to the slice, 0, 1 or 2; for 3D images.
  int axis = 2;
  /// Index of the slice along this axis, from 0; -1: the slice with the largest area inside any of the fields.
  Index slice = -1;
  Index frame = 0;
  /// Least number of pixels along the longest side, 1 to 16384: voxels are enlarged by the smallest integer factor that
  /// reaches it, anisotropic ones in proportion to their spacings.
  int size = 512;
  /// Quantiles of the values in the slice that are shown as black and white, from 0 to 1.
  std::array<double, 2> window{0.01, 0.99};

  /// The contours f = level are drawn.
  double level = 0;

  double line_width = 1.5;  ///< pixels

  /// Colours of the contours, repeated if there are more fields. Default: red, yellow, blue, green, magenta, white.
  std::vector<RgbColor> colors{};
};

/// Makes a picture of an image, or of a slice of it, with the contours of fields drawn on it. The fields are functions
/// of the physical coordinates of the image (Grid::to_physical). Values within the window are grey, images with three
/// or more components coloured, missing values black.
///
/// Columns and rows are those of the slice, with the first row at the top; z points upwards. Images in patient space
/// follow the radiological convention: the left of the patient is on the right, the front at the top or on the left.
///
/// Throws InvalidInput for a slice, axis or frame that does not exist, a size or window out of range, and a 3D image if
/// Dim is 2.
template <int Dim>
RgbImage preview(const Volume<float>& image, const std::vector<const Field<Dim>*>& fields,
                 const PreviewOptions& options = {});

/// Index of the slice perpendicular to an axis that has the largest area inside any of the fields: f >= level at 64 x
/// 64 points of each slice. The middle slice if nothing is inside. Throws InvalidInput unless axis is 0, 1 or 2.
template <int Dim>
Index largest_slice(const Grid& grid, const std::vector<const Field<Dim>*>& fields, int axis, double level = 0);

}  // namespace csrbf
