#pragma once

#include "figure.hpp"

#include <vector>

namespace csrbf::thesis {

/// Eq. (1.5): the function of bandwidth W (Hz) through the values s_k at k / (2 W), k = first, first + 1, ...; values
/// that are not given count as 0.
double band_limited(const Eigen::VectorXd& values, Index first, double W, double x);

/// Section 1.1.1: the polynomial of degree m with the least squares error at the samples, evaluated at x. All
/// coordinates in [-1, 1]. Throws InvalidInput when the samples do not determine it (Mairhuber: no space of polynomials
/// is unisolvent for all point sets when d > 1).
template <int Dim>
Eigen::VectorXd global_polynomial(const Points<Dim>& points, const Eigen::VectorXd& values, int degree,
                                  const Points<Dim>& x);

/// Section 1.4: reconstruction in the space of the functions sum_k c_k Phi(x - k), Phi the cubic B-spline, by the frame
/// iteration (1.18)-(1.20).
struct FrameIteration {
  double A = 0, B = 0;           ///< frame bounds (1.16)
  Eigen::MatrixXd coefficients;  ///< c of f_n, one column per iteration
};

/// The cubic B-spline of integer knots, support (-2, 2).
double cubic_b_spline(double x);

/// `points` in [0, count - 1]; c_k for k = 0, ..., count - 1. With the Gram matrix G_kl = <Phi(. - k), Phi(. - l)> and
/// U_ik = Phi(p_i - k) the reproducing kernel (1.15) of p_i has the coefficients G^-1 U_i^T (the printed formula lacks
/// the tilde of the dual generator), so T is G^-1 U^T U and A, B are its extreme eigenvalues. Throws SolverFailure when
/// A = 0: too large a gap.
FrameIteration frame_iteration(const Eigen::VectorXd& points, const Eigen::VectorXd& values, Index count,
                               Index iterations);

/// All of them side by side.
Figure baselines();

}  // namespace csrbf::thesis
