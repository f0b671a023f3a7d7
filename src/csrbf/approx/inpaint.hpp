#pragma once

#include "csrbf/approx/fit.hpp"
#include "csrbf/core/grid.hpp"

#include <optional>
#include <vector>

namespace csrbf {

/// What fills the missing voxels of an image, as trials at known ones choose it.
struct InpaintPlan {
  std::string kernel = "auto";         ///< of the fit
  std::optional<int> degree = {};      ///< of the fit
  std::optional<double> tension = {};  ///< of a spline on the grid in place of the fit; 0: a thin plate
  Index blocks = 0;                    ///< width of the blocks that refine what it says; 0: none
  double thin_plate = 0;               ///< share of a thin plate in the mean that the result is
  std::vector<double> errors = {};     ///< before the blocks, root mean squares of the components in the trials
};

struct InpaintOptions : FitOptions {
  /// Width in voxels of the blocks whose cosine transforms refine what the fit says (refine_by_sparse_blocks()): 4 to
  /// 64, 0: none. Unset: 8, in holes up to 32, or none where voxels hidden for a trial ask for that; none where a
  /// method, kernel, degree, smoothing, tolerance or budget is given. Images of one axis have none.
  std::optional<int> blocks = {};
  /// Not chosen by trials: that of another part of the same image.
  std::optional<InpaintPlan> plan = {};
};

/// What inpaint() did. Counts are of values: voxels times components times frames.
struct InpaintReport {
  Index missing = 0;  ///< replaced
  Index known = 0;
  InpaintPlan plan;  ///< of the first component and frame with missing values
  FitReport fit;     ///< of the same; its `samples` are the known voxels used
};

/// Fills missing or unreliable voxels of an image of up to 3 axes, every frame and component separately, by a function
/// fitted to the known values (see fit()). Distances are physical, which accounts for voxels that are longer in one
/// direction. Known values do not change; filled ones are neither rounded nor clamped.
///
/// `missing`: one entry per voxel, or per voxel of every frame, not 0 where the values are to be replaced. Values that
/// are not finite are missing as well.
///
/// Known voxels far from all missing ones do not matter: only those within a city-block distance of 8 voxels, or of
/// twice the depth of the deepest hole where that is more, are samples of the fit, provided that these are less than
/// half of the known voxels; otherwise all of them are. O(n) time and memory in addition to the fit.
///
/// The method auto is a partition of unity, except for a tolerance, a budget of centres, a given kernel or up to 100
/// samples (see FitOptions). Where voxels are missing in holes instead of one by one, its kernel is the one of three
/// (that of cross-validation, wendland-c2, wendland-c0) with the smallest error in holes of the same shape among known
/// voxels: smooth images need smooth kernels, which overshoot in texture.
///
/// A spline on the grid (fill_by_grid_spline()) takes the place of the fit where it errs less in those trials, or at
/// single hidden voxels where voxels are missing one by one, unless a method, kernel, degree, smoothing, tolerance or
/// budget is given. In holes of images that are not smooth only splines are tried: there the fit is no better and takes
/// seconds. The report then says grid-spline.
///
/// What the fit says is then refined by blocks, which continue edges and textures (see InpaintOptions::blocks). The
/// result is a mean of this and a thin plate on the grid, with the weights that suit the hidden voxels, unless
/// blocks are none.
///
/// Throws InvalidInput when `missing` has another size, a frame has no known value or the width of the blocks is out of
/// its range, and what fit() throws.
template <class Scalar>
InpaintReport inpaint(Volume<Scalar>& image, const std::vector<unsigned char>& missing, const InpaintOptions& options);

/// The same with what is common to all fits: `inpaint(image, missing, {.method = "interpolate"})`.
template <class Scalar>
InpaintReport inpaint(Volume<Scalar>& image, const std::vector<unsigned char>& missing,
                      const FitOptions& options = {}) {
  return inpaint(image, missing, InpaintOptions{options});
}

}  // namespace csrbf
