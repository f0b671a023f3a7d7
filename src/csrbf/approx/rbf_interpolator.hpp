#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

#include <memory>
#include <optional>
#include <string>

namespace csrbf {

struct RbfInterpolatorOptions {
  /// 0: one interpolant of all points. Otherwise every query is evaluated by an interpolant of so many points nearest
  /// to it, or of all points if there are fewer.
  Index neighbors = 0;
  /// Added to the diagonal of the system: one number for all points, or one for each; empty: 0. Negative numbers may
  /// make the system ill-posed.
  Eigen::VectorXd smoothing = {};
  /// linear, thin_plate_spline, cubic, quintic, multiquadric, inverse_multiquadric, inverse_quadratic, gaussian, or a
  /// name of Kernel.
  std::string kernel = "thin_plate_spline";
  /// The kernel is phi(epsilon r). May be unset, for 1, if the kernel has no scale.
  std::optional<double> epsilon = {};
  /// Degree of the polynomial; -1: none. Unset: the smallest one with which the system is always solvable, but at least
  /// 0.
  std::optional<int> degree = {};
  Progress progress = {};
};

/// Interpolates or smooths scattered data by one radial function per point and a polynomial, or by such interpolants
/// over nearest neighbours: the model and conventions of SciPy's class of the same name. Usually fit() is the better
/// tool: its functions are smooth where local interpolants jump, it chooses its options, and it takes O(n).
///
///     (A + diag(smoothing)) alpha + G pi = values,   G^T alpha = 0,   A_ij = phi(epsilon |y_i - y_j|)
///
/// The polynomials G are in coordinates that map the bounding box of the points to [-1, 1]^d. Any dimension.
class RbfInterpolator {
 public:
  /// `points`: d x n; `values`: k x n. With neighbours O(n log n). Without, O(n^3) up to 4000 points. More points in
  /// one to three dimensions take O(n), by conjugate gradients with fast sums to residuals of 1e-8 of the largest
  /// value, unless the degree is below the smallest one or, up to 10,000 points, the system is too ill conditioned.
  ///
  /// Throws InvalidInput for sizes that do not match, numbers that are not finite, unknown kernels, a missing epsilon,
  /// and fewer points than the polynomial has coefficients; SolverFailure if the system is singular; Cancelled.
  RbfInterpolator(const Eigen::Ref<const Eigen::MatrixXd>& points, const Eigen::Ref<const Eigen::MatrixXd>& values,
                  const RbfInterpolatorOptions& options = {});

  RbfInterpolator(RbfInterpolator&&) noexcept;
  RbfInterpolator& operator=(RbfInterpolator&&) noexcept;
  ~RbfInterpolator();

  /// An interpolant that is already solved, from the `coefficients` (k x (n + Q)) that coefficients() returned.
  static RbfInterpolator restore(const Eigen::Ref<const Eigen::MatrixXd>& points,
                                 const Eigen::Ref<const Eigen::MatrixXd>& coefficients,
                                 const RbfInterpolatorOptions& options);

  /// Values (k x m) at the points x (d x m), on all threads. Without neighbours O(m n), for more than 8000 points in up
  /// to three dimensions O(m + n). With neighbours O(m (log n + neighbors^3)); queries that share a local system solve
  /// it once. Without neighbours, queries that are not finite give NaN.
  ///
  /// Throws InvalidInput if the number of rows is not d and, with neighbours, for queries that are not finite;
  /// SolverFailure if a local system is singular.
  [[nodiscard]] Eigen::MatrixXd evaluate(const Eigen::Ref<const Eigen::MatrixXd>& x,
                                         const Progress& progress = {}) const;

  [[nodiscard]] Index dimension() const;
  [[nodiscard]] Index neighbors() const;
  [[nodiscard]] int degree() const;
  /// The smallest degree with which the system is always solvable: the order of the kernel minus 1.
  [[nodiscard]] static int smallest_degree(const std::string& kernel, Index dimension);
  [[nodiscard]] double epsilon() const;
  [[nodiscard]] Eigen::MatrixXi powers() const;

  /// alpha and pi, k x (n + Q); empty with neighbours.
  [[nodiscard]] Eigen::MatrixXd coefficients() const;

 private:
  struct Data;
  explicit RbfInterpolator(std::unique_ptr<const Data> data);

  std::unique_ptr<const Data> data_;
};

}  // namespace csrbf
