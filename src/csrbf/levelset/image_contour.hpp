#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/implicit/contour_lines.hpp"
#include "csrbf/implicit/polygonize.hpp"

namespace csrbf {

struct ImageContourOptions {
  /// Cells along the longest side of the image, 1 to 4096. 0: one cell per feature size of the level set
  /// (automatic_resolution()), in 2D two.
  int resolution = 0;
  Progress progress = {};  ///< stages of contour_lines() and polygonize()
};

/// The contour of a level set in a 2D image.
struct ImageContour {
  /// In the axes of the image: column and row times the spacing, with the centre of the first voxel at (0, 0); with
  /// length and area.
  ContourLines lines;
  /// Maps these coordinates, with z = 0, to space.
  Eigen::Matrix<double, 3, 4> placement = Eigen::Matrix<double, 3, 4>::Identity();
  Box<2> image;  ///< the image, to the outer borders of its first and last voxels
};

/// The surface of a level set in a 3D image.
struct ImageSurface {
  Mesh mesh;              ///< in physical coordinates, closed along the border of the image
  double area = 0;        ///< of the surface, without the parts along the border of the image
  double volume = 0;      ///< of the inside, within the image
  double area_error = 0;  ///< estimates of the errors of area and volume; usually too large
  double volume_error = 0;
};

/// The part of the image where a level set is positive, cut off at the image border. The field is a function of the
/// physical coordinates of the grid. The axes of the image must span the first Dim axes of space.
///
/// In 3D, area and volume are those of quadratic patches over the triangles, with the normals of the field at the
/// corners: errors fall with the fourth power of the cell size on smooth surfaces. The estimate of the error is the sum
/// of the absolute differences between patches and triangles, a second-order term that is larger than the error. A
/// level set without a zero in the image gives an empty mesh. Cost as contour_lines() and polygonize().
///
/// Throws InvalidInput for grids of another dimension and a resolution out of range; SolverFailure if the field is not
/// finite; Cancelled.
ImageContour image_contour(const Field<2>& field, const Grid& grid, const ImageContourOptions& options = {});
ImageSurface image_contour(const Field<3>& field, const Grid& grid, const ImageContourOptions& options = {});

}  // namespace csrbf
