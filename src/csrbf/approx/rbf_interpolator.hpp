#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

#include <memory>
#include <optional>
#include <string>

namespace csrbf {

struct RbfInterpolatorOptions {
  /// 0: one interpolant of all points. Otherwise every query is evaluated by the interpolant of that many points
  /// nearest to it (all points if there are fewer).
  Index neighbors = 0;
  /// Added to the diagonal of the system, >= 0 for it to be well posed: one entry for all points, or one each; empty:
  /// 0.
  Eigen::VectorXd smoothing = {};
  /// linear, thin_plate_spline, cubic, quintic, multiquadric, inverse_multiquadric, inverse_quadratic, gaussian, or a
  /// name of Kernel.
  std::string kernel = "thin_plate_spline";
  /// Kernels are phi(epsilon r). May be unset, for 1, when the kernel has no scale.
  std::optional<double> epsilon = {};
  /// Of the polynomial, -1 for none; unset: the smallest with which the system is always solvable, and at least 0.
  std::optional<int> degree = {};
  Progress progress = {};
};

/// Interpolation or smoothing of scattered data by one radial function per point and a polynomial, or by local such
/// interpolants over nearest neighbours: the model and the conventions of SciPy's class of that name. For scattered
/// data in general fit() is the better tool: its functions are smooth where local interpolants jump, it chooses what
/// has to be given here, and takes O(n).
///
///     (A + diag(smoothing)) alpha + G pi = values,   G^T alpha = 0,   A_ij = phi(epsilon |y_i - y_j|)
///
/// with the polynomials G in coordinates that map the bounding box of the points to [-1, 1]^d. Any dimension.
class RbfInterpolator {
 public:
  /// `points`: d x n; `values`: k x n. With neighbours O(n log n). Without, O(n^3) up to 4000 points; more in one to
  /// three dimensions O(n), by conjugate gradients with fast sums, to residuals of 1e-8 of the largest value (see
  /// solve_iteratively()), unless the degree is below the smallest one, or, up to 10,000 points, the system too ill
  /// conditioned.
  /// Throws InvalidInput for sizes that do not match, numbers that are not finite, unknown kernels, a scale that is
  /// missing and fewer points than the polynomial has coefficients; SolverFailure when the system is singular.
  RbfInterpolator(const Eigen::Ref<const Eigen::MatrixXd>& points, const Eigen::Ref<const Eigen::MatrixXd>& values,
                  const RbfInterpolatorOptions& options = {});

  RbfInterpolator(RbfInterpolator&&) noexcept;
  RbfInterpolator& operator=(RbfInterpolator&&) noexcept;
  ~RbfInterpolator();

  /// One that is already solved, with `coefficients` (k x (n + Q)) as returned by coefficients().
  static RbfInterpolator restore(const Eigen::Ref<const Eigen::MatrixXd>& points,
                                 const Eigen::Ref<const Eigen::MatrixXd>& coefficients,
                                 const RbfInterpolatorOptions& options);

  /// Values (k x m) at the points x (d x m), on all threads. O(m n), for more than 8000
  /// points in up to three dimensions O(m + n), or O(m (log n + neighbors^3)) with systems that
  /// several queries share solved once. Queries that are not finite give NaN without neighbours.
  /// Throws InvalidInput for another dimension and, with neighbours, for queries that are not finite; SolverFailure
  /// when a local system is singular.
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
