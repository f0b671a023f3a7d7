#pragma once

#include "csrbf/core/grid.hpp"

#include <vector>

namespace csrbf {

/// What moves a dense level set: f_t = (speed + curvature K) |grad f| + penalty div((1 - 1 / |grad f|) grad f), with
/// K = div(grad f / |grad f|). Lengths are in the unit of the spacing.
struct DenseMotion {
  const float* speed = nullptr;  ///< one per voxel: outwards; null: 0
  double curvature = 0;          ///< >= 0: shortens the contour
  double penalty = 0;            ///< >= 0: keeps |grad f| at 1, eq. (7.18) (Li et al. 2005)
};

/// A level set by its values at the voxels, and the finite differences that move it: upwind (Godunov) for the speed,
/// central ones for curvature and penalty; the image continues beyond its border as it is there. 2D and 3D, voxels of
/// any edges. Only voxels in the narrow band |f| < band move; the others keep -+band. On all threads, bit-identical for
/// every number of them. The cost of a step is that of the band.
template <int Dim>
class DenseLevelSet {
 public:
  /// `values`: one per voxel, x fastest. `band` in the unit of the spacing; infinite: all voxels.
  DenseLevelSet(const Grid& grid, std::vector<float> values, double band);

  /// The largest stable step of Euler for speeds up to `largest_speed`.
  [[nodiscard]] double stable_step(double largest_speed, const DenseMotion& motion) const;

  /// One step of Euler.
  void step(const DenseMotion& motion, double tau);

  /// Makes f the signed distance to its zero set again, eq. (7.17), by upwind steps within the band; next to the zero
  /// set from the subcell position of the zeros, which so stay where they are (Russo and Smereka 2000). `steps` of half
  /// a voxel edge. The band follows the zero set, which may have moved by `moved` voxels since the last time.
  void reinitialize(int steps, int moved = 1);

  /// f_t of the motion at the voxels of the band.
  [[nodiscard]] std::vector<float> rate(const DenseMotion& motion) const;

  [[nodiscard]] const std::vector<float>& values() const { return values_; }
  /// Voxels in the band, ascending.
  [[nodiscard]] const std::vector<Index>& active() const { return active_; }

 private:
  // Values around a voxel and the differences of them.
  struct Stencil;
  [[nodiscard]] Stencil stencil(const std::vector<float>& f, Index voxel) const;
  [[nodiscard]] double penalty_rate(const Stencil& s) const;
  [[nodiscard]] std::vector<float> anchors() const;
  void find_band();
  void widen_band(int voxels);

  Grid grid_;
  std::vector<float> values_;
  double band_;
  std::vector<Index> active_;
};

}  // namespace csrbf
