#pragma once

#include "csrbf/approx/fit.hpp"
#include "csrbf/core/grid.hpp"

#include <optional>
#include <vector>

namespace csrbf {

/// How missing voxels are filled, as chosen by trials at known voxels.
struct InpaintPlan {
  std::string kernel = "auto";         ///< of the fit
  std::optional<int> degree = {};      ///< of the fit
  std::optional<double> tension = {};  ///< of a spline on the grid, which replaces the fit; 0: a thin plate
  Index blocks = 0;                    ///< width of the blocks that refine the result, in voxels; 0: none
  double thin_plate = 0;               ///< weight of a thin plate in the mean that is the result
  std::vector<double> errors = {};     ///< root mean square errors of the components in the trials, before the blocks
};

struct InpaintOptions : FitOptions {
  /// Width of the blocks whose sparse cosine transforms refine the result, in voxels: 4 to 64; 0: none. Unset: 8, in
  /// holes up to 32, or none, whichever suits voxels hidden for a trial; none if a method, kernel, degree, smoothing,
  /// tolerance or budget is given. Images with one axis have none.
  std::optional<int> blocks = {};
  /// Replaces the trials: the plan of another part of the same image.
  std::optional<InpaintPlan> plan = {};
};

/// What inpaint() did. Counts are of values: voxels times components times frames.
struct InpaintReport {
  Index missing = 0;  ///< replaced
  Index known = 0;
  InpaintPlan plan;  ///< of the first component and frame with missing values
  FitReport fit;     ///< of the same; its `samples` are the known voxels used
};

/// Fills missing or unreliable voxels of an image of up to 3 axes with a function fitted to the known ones, see fit().
/// Every frame and component is filled on its own. Distances are physical, so voxels may be longer in one direction.
/// Known values do not change; filled ones are neither rounded nor clamped.
///
/// `missing`: one entry per voxel, or per voxel of every frame; nonzero where the value is to be replaced. Values that
/// are not finite are missing as well.
///
/// Known voxels far from all missing ones do not matter. The samples of the fit are those within a city-block distance
/// of 8 voxels, or of twice the depth of the deepest hole if that is more; if these are at least half of the known
/// voxels, all are samples. O(n) time and memory in addition to the fit.
///
/// The method `auto` is a partition of unity, except with a tolerance, a budget of centres, a given kernel or up to 100
/// samples (see FitOptions). If voxels are missing in holes instead of one by one, three kernels are tried: that of
/// cross-validation, wendland-c2 and wendland-c0. The one with the smallest error in holes of the same shape among
/// known voxels is taken: smooth images need smooth kernels, which overshoot in texture.
///
/// A spline on the grid replaces the fit if it has smaller errors in those trials or, where voxels are missing one by
/// one, at single hidden voxels; not if a method, kernel, degree, smoothing, tolerance or budget is given. In holes of
/// images that are not smooth only splines are tried: the fit is no better there and takes seconds. The report then
/// says grid-spline.
///
/// Blocks then refine the result and continue edges and textures (see InpaintOptions::blocks). The final values are a
/// mean of this and a thin plate on the grid, with the weights that suit the hidden voxels, unless there are no blocks.
///
/// Throws InvalidInput if `missing` has a wrong size, a frame has no known value or the block width is out of range,
/// and as fit().
template <class Scalar>
InpaintReport inpaint(Volume<Scalar>& image, const std::vector<unsigned char>& missing, const InpaintOptions& options);

/// The same with options common to all fits: `inpaint(image, missing, {.method = "interpolate"})`.
template <class Scalar>
InpaintReport inpaint(Volume<Scalar>& image, const std::vector<unsigned char>& missing,
                      const FitOptions& options = {}) {
  return inpaint(image, missing, InpaintOptions{options});
}

}  // namespace csrbf
