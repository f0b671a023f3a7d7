#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/implicit/contour_lines.hpp"
#include "csrbf/implicit/polygonize.hpp"

namespace csrbf {

struct ImageContourOptions {
  int resolution =
      0;  ///< cells along the longest side of the image; 0: the feature size of the level set, in the plane half of it
  Progress progress = {};  ///< stages of contour_lines() and polygonize()
};

/// The contour of a level set in the plane of an image.
struct ImageContour {
  /// In the axes of the image: column and row times the spacing, so that the centre of the first voxel is (0, 0); with
  /// length and area.
  ContourLines lines;
  Eigen::Matrix<double, 3, 4> placement =
      Eigen::Matrix<double, 3, 4>::Identity();  ///< from these coordinates, with z = 0, to those of space
  Box<2> image;  ///< the image: from the outer borders of its first voxels to those of its last
};

/// The surface of a level set in a volume.
struct ImageSurface {
  Mesh mesh;              ///< in physical coordinates, closed along the border of the image
  double area = 0;        ///< of the surface, without what runs along the border
  double volume = 0;      ///< of what is inside, within the image
  double area_error = 0;  ///< estimates of the errors of both
  double volume_error = 0;
};

/// Where a level set is positive, cut off at the border of the image. The field is a function of the physical
/// coordinates of the grid; the image may lie in space in any way that its axes span the first Dim axes of space.
///
/// Areas and volumes in space are those of quadratic patches over the triangles, with the normals of the field at their
/// corners: the errors fall as the fourth power of the cell on smooth surfaces. What the patches add to the triangles
/// is the term of second order; the sum of its absolute values is the estimate of the error, larger than the error. A
/// level set without a zero in the image has an empty mesh. Cost as contour_lines() and polygonize(). Throws
/// InvalidInput for grids of other dimensions and a resolution out of range; SolverFailure when the field is not
/// finite; Cancelled.
ImageContour image_contour(const Field<2>& field, const Grid& grid, const ImageContourOptions& options = {});
ImageSurface image_contour(const Field<3>& field, const Grid& grid, const ImageContourOptions& options = {});

}  // namespace csrbf
