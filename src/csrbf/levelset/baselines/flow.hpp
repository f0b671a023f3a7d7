#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/levelset/baselines/nodes.hpp"

#include <functional>
#include <memory>
#include <string>

namespace csrbf {

/// A moving level set at its nodes: what velocities may depend on.
template <int Dim>
struct FlowState {
  const Points<Dim>& points;
  const Eigen::VectorXd& value;
  const Points<Dim>& gradient;
  /// Sum of the principal curvatures of the level set through each node, -div(grad f / |grad f|): positive where the
  /// inside is convex.
  const Eigen::VectorXd& curvature;
  double time;
};

/// The terms whose sum moves a level set; those not given are 0. Functions write one number or vector per node.
template <int Dim>
struct FlowLaw {
  using Scalars = std::function<void(const FlowState<Dim>&, Eigen::VectorXd& out)>;
  using Vectors = std::function<void(const FlowState<Dim>&, Points<Dim>& out)>;

  Scalars force = {};     ///< V of f_t + V delta_eps(f) = 0, eq. (7.11)
  Scalars speed = {};     ///< V_n of f_t = V_n |grad f|: outwards, eq. (7.13) with the sign of the errata
  Vectors velocity = {};  ///< V of f_t + <V, grad f> = 0, eq. (7.14)
  double curvature = 0;   ///< mu >= 0 of f_t = mu |grad f| div(grad f / |grad f|): shrinks length (3D: area)
  double diffusion = 0;   ///< mu >= 0 of f_t = mu laplacian f
};

enum class FlowIntegrator {
  ssp_rk3,  ///< strong stability preserving Runge-Kutta of order 3 (Shu and Osher 1988)
  rk4,      ///< the classical one of order 4
  /// (H - tau mu L) alpha' = H alpha + tau (all other terms): order 1, stable for steps of any length if there are only
  /// curvature and diffusion. mu is the sum of both; the normal part of the Laplacian is among the other terms.
  semi_implicit,
};

struct FlowOptions {
  std::string kernel = "wendland-c4";  ///< compact, with two derivatives
  /// Support radius in node spacings, above 1. Curvatures need wendland-c4 and at least 5.5: the relative error of the
  /// derivatives depends on this number alone and is 0.2 % by default. So to converge, refine the nodes at a fixed
  /// radius in physical units, not at a fixed multiple of their spacing.
  double support = 5.5;
  FlowIntegrator integrator = FlowIntegrator::ssp_rk3;
  double eps = 1.25;       ///< half width of delta, in node spacings
  double time_step = 0;    ///< 0: 0.9 of the largest stable step; semi_implicit: a quarter node spacing of motion
  Progress progress = {};  ///< stage "flow"
};

template <int Dim>
struct FlowResult {
  std::shared_ptr<const Field<Dim>> field;
  Eigen::VectorXd values;  ///< at the nodes
  Index steps = 0;
  double largest_step = 0;  ///< in units of time
};

/// Moves the level set `start` for the time `duration`: f = c + sum_j alpha_j phi(|p - p_j| / sigma), whose values at
/// the nodes follow equations (7.11), (7.13) and (7.14) of the thesis, with c the mean of the start over the outermost
/// nodes. Forward Euler, used in the thesis, is unstable for the last two, because the differentiation matrix has an
/// imaginary spectrum. Steps are bounded by that spectrum, h / (1.9 sqrt(Dim) |V|) for ssp_rk3 and
/// h / (1.2 sqrt(Dim) |V|) for rk4, by that of the Laplacian, and by a change of one node spacing for the force. |grad
/// f| is taken without upwinding, so f should be smooth and flatten towards the border, which the contour must not
/// reach.
///
/// Regular nodes are fast and accurate; scattered ones need wider supports.
///
/// Throws InvalidInput for options out of range, kernels with fewer than two derivatives, and an unstable time step,
/// naming the largest stable one; SolverFailure if H is singular; Cancelled.
template <int Dim>
FlowResult<Dim> flow(const Nodes<Dim>& nodes, const Field<Dim>& start, double duration, const FlowLaw<Dim>& law,
                     const FlowOptions& options = {});

}  // namespace csrbf
