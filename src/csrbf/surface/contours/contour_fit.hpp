#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/surface/contours/slice_signs.hpp"

#include <memory>

namespace csrbf {

struct ContourFitOptions {
  Index centers = 0;     ///< largest number of basis functions of the spline
  double smoothing = 0;  ///< >= 0: lambda of the spline; 0 interpolates
  Progress progress = {};
};

struct ContourFit {
  std::shared_ptr<const Field<3>> field;  ///< f > 0 inside, of slope about 1 at the contours
  Index centers = 0;                      ///< basis functions
  Points<3> seeds{3, 0};                  ///< well spread contour points
  double spacing = 0;                     ///< between them
  std::vector<Cap> caps;                  ///< that close the surface
};

/// A smooth function that is 0 on contours and has the right sign in the planes of all slices. Lengths in units of the
/// diagonal of the contours' box.
///
/// It is a triharmonic spline sum_j a_j |x - c_j|^3 + linear, the function with the least mean square of third
/// derivatives under the following conditions, corrected by levels of CSRBFs at the contour points that are not among
/// its centres.
/// - f = 0 at well spread contour points.
/// - Normals are known within the slices only: f = e cos t at the distance e from the contour within the slice, where t
///   is the angle between the slice and the normal of the surface. t is found by a few steps of a fixed-point
///   iteration from t = 0, in which cos t is the in-plane share of the gradient of the previous fit.
/// - The sign of f is known everywhere in the planes of the slices. Where the fit has the wrong sign, values of the
///   right sign are added as conditions.
ContourFit fit_contours(const Points<3>& points, const std::vector<ContourLoop>& loops, const Slices& slices,
                        const ContourFitOptions& options);

}  // namespace csrbf
