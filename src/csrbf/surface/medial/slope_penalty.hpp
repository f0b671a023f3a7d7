#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/surface/medial/medial_axis_field.hpp"

#include <Eigen/SparseCore>

namespace csrbf {

/// The least squares problem for the coefficients alpha of fit_medial_axis() (thesis eqs. 6.32 to 6.35).
struct SlopeSystem {
  using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

  Rows B;                    ///< B_kj = w_j(p_k), w_j = phi_j / sum phi
  std::array<Rows, 3> D;     ///< D_kj = sigma_j / K' grad w_j(p_k), with the sparsity of B
  Eigen::VectorXd residual;  ///< -f(p_k) for alpha = 0
  Eigen::VectorXd slope;     ///< -n_k . grad f(p_k) for alpha = 0
  Points<3> normals;         ///< n_k, 3 x N
  Eigen::VectorXd supports;  ///< sigma_j
};

/// The system for samples with outward normals.
SlopeSystem slope_system(const MedialAxisField::Data& data, const PointsRef<3>& samples, const PointsRef<3>& normals);

struct SlopeSolution {
  Eigen::VectorXd alpha;
  double smoothing = 0;
};

/// Minimises |B alpha - residual|^2 + mu |D alpha|^2, mu = smoothing N / trace(D^T D). Without `smoothing` it is chosen
/// by generalised cross-validation of f divided by its mean slope at the samples, -n . grad f: values alone would
/// favour a flat f under noise. For more than 2000 centres this is done on blocks of neighbours all over the surface,
/// the fewer and larger the more centres there are in a support.
SlopeSolution solve_slope_system(const SlopeSystem& system, std::optional<double> smoothing, const Progress& progress);

}  // namespace csrbf
