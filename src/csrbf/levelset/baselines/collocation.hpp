#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/levelset/baselines/nodes.hpp"
#include "csrbf/levelset/segment_options.hpp"

#include <memory>
#include <string>
#include <vector>

namespace csrbf {

/// How the velocity at a node follows from the forces on the voxels.
enum class VelocitySampling {
  kernel_average,  ///< sum_q phi(|q - p_i| / h) V(q) / sum_q phi(|q - p_i| / h), h the spacing of the nodes
  nearest_voxel,
};

/// What keeps the level set from growing without limit.
enum class LevelSetBound {
  none,
  cap,      ///< scaled down when its largest value at a node exceeds the bound
  l1_norm,  ///< eq. (8.28) literally: |alpha|_1 = sigma after every step, scaled up or down
};

/// The defaults are those of the thesis, with its errata: rho = 4, a bound, and a delta so wide that it acts on all
/// level curves.
struct CollocationOptions {
  std::string kernel = "wendland-c2";                           ///< any name of Kernel
  double parameter = std::numeric_limits<double>::quiet_NaN();  ///< of the kernel; NaN: its default
  /// rho, eq. (8.17): support or length scale of the kernel, in fill distances of the nodes. 0: 4 for compact kernels,
  /// else 1. Ignored for kernels without a scale.
  double support = 0;
  VelocitySampling sampling = VelocitySampling::kernel_average;
  LevelSetBound bound = LevelSetBound::cap;
  /// Bound on the values at the nodes, in node spacings; above 0. Applied to the start (except with l1_norm) and, with
  /// `cap`, after every step.
  double largest_value = 3;
  /// Half width of delta, eq. (7.12), in node spacings. 1 to 1.5: only the contour moves. 0: acts everywhere; the half
  /// width is then the bound, or with l1_norm 2 sigma, as in the thesis.
  double eps = 0;
  /// Largest change of a value at a node in one iteration, in node spacings: tau = step h pi eps. Above 0; with `cap`
  /// it should be at most 1.
  double step = 1;
  int iterations = 200;  ///< at most
  /// Converged if at most this share of the voxels changes labels in each of 3 / step (at least 3) successive
  /// iterations.
  double tolerance = 0;
  Progress progress = {};  ///< stage "evolve"
};

template <int Dim>
struct CollocationResult {
  std::shared_ptr<const Field<Dim>> field;
  std::vector<unsigned char> labels;  ///< 1 where f > 0; one per voxel
  int iterations = 0;
  bool converged = false;
  /// After each iteration: the number of labels that changed; the largest change of a coefficient (Fig. 8.5 a, c); and
  /// what the voxels on the wrong side would save by changing sides, as a share of sum |force|. The energy itself is
  /// known to the ForceUpdate only.
  std::vector<Index> changes;
  std::vector<double> coefficient_changes;
  std::vector<double> gaps;
  double support = 0;  ///< sigma; like the next three, in the unit of the spacing
  double node_spacing = 0, eps = 0, tau = 0;
  /// Time spent on H and its factorisation, on solving with it, on values at the voxels, and on forces.
  double system_seconds = 0, solve_seconds = 0, evaluate_seconds = 0, force_seconds = 0;
};

/// The level set method of the thesis (chapter 8): f = sum_j alpha_j phi(|p - p_j| / sigma) follows
/// f_t = -V delta_eps(f) at its nodes, eqs. (7.11), (8.14), (8.18), by Euler steps: alpha <- alpha - tau H^-1 B, B_i =
/// V_i delta_eps(f_i), eqs. (8.25)-(8.27), with the signs of the errata and V scaled to max |V| = 1.
///
/// This is a faithful baseline, not the best that these centres can do. At the nodes it is the ordinary differential
/// equation s_i' = -V_i delta_eps(s_i), separate for each node; the CSRBFs merely interpolate between the nodes. With
/// forces from two means it thresholds the image at the nodes.
///
/// `nodes` may be regular or not, denser where detail is expected. The start is a field or the signed distance to the
/// boundary of labels (1 inside). The image has Dim axes; coordinates are physical.
///
/// Throws InvalidInput for options out of range and an image of another dimension; SolverFailure if H is singular;
/// Cancelled.
template <int Dim>
CollocationResult<Dim> collocate(const Grid& grid, const Nodes<Dim>& nodes, const Field<Dim>& start,
                                 const ForceUpdate& force, const CollocationOptions& options = {});
template <int Dim>
CollocationResult<Dim> collocate(const Grid& grid, const Nodes<Dim>& nodes, const unsigned char* start,
                                 const ForceUpdate& force, const CollocationOptions& options = {});

}  // namespace csrbf
