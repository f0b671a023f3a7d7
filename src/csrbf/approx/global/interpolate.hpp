#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/linalg/ridge.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace csrbf {

template <int Dim>
class Expansion;
template <int Dim>
class KrigingVariance;
template <int Dim>
struct RadialMetric;

struct InterpolateOptions {
  /// A name of Kernel, or "auto": the kernel with the smallest leave-one-out error. Beyond `dense_limit` samples its
  /// candidates are linear, thin-plate and, in up to two dimensions, cubic; on periodic axes, and beyond `dense_limit`
  /// samples in more than three dimensions, Wendland functions.
  std::string kernel = "auto";
  double parameter = std::numeric_limits<double>::quiet_NaN();  ///< of the kernel; NaN: its default

  /// Support radius or length scale sigma, in the unit of the points (1 / epsilon elsewhere). 0: chosen by
  /// leave-one-out; for kernels without a scale half the largest extent of the data, which only changes the meaning of
  /// `smoothing`.
  double support = 0;

  /// lambda >= 0 of A + lambda W^-1, with weights of mean 1. For kernels with the value 1 at 0 it is roughly the
  /// variance of the noise over that of the data. 0: interpolates; empty: chosen from all samples.
  std::optional<double> smoothing = 0;
  LambdaCriterion criterion = LambdaCriterion::leave_one_out;  ///< by which lambda is chosen
  /// Whether weights are used as given: lambda and the variances are then for samples of weight 1, even if samples are
  /// means of several.
  bool keep_weights = false;

  /// Degree of the polynomial, at least the order of the kernel minus 1; -1: none; -2: that order minus 1, but at least
  /// 0.
  int degree = -2;
  /// Whether it is an error if the points do not determine the polynomial. Otherwise only its determined part is used.
  bool require_degree = true;

  Index dense_limit = 4000;  ///< largest number of distinct samples for a dense system
  /// Largest residual at a sample of systems solved by fast sums, in units of the largest |value|. 0: 1e-8, in 3D 1e-7.
  double tolerance = 0;
  /// Above 0: radial functions only at as many samples as it takes for the error at all samples to be at most this, in
  /// the unit of the values. They are added greedily where errors are largest (Carr et al. 2001). 0: at all samples.
  double largest_error = 0;
  Progress progress = {};  ///< stages "choose", "solve"
};

enum class InterpolationSolver { dense, sparse_direct, sparse_iterative, fast_sums };

struct InterpolationReport {
  std::string kernel;    ///< its name
  double support = 0;    ///< given or chosen
  double smoothing = 0;  ///< given or chosen; also positive if rounding made the system singular
  int degree = -1;       ///< of the polynomial
  /// Weighted root mean square of the leave-one-out errors over all components. Exact for dense systems, estimated for
  /// those solved by fast sums and for sparse ones whose support was chosen; NaN otherwise.
  double leave_one_out = 0;
  double condition = 0;  ///< estimate for dense systems; NaN otherwise
  Index merged = 0;      ///< samples merged with another one at the same point
  InterpolationSolver solver = InterpolationSolver::dense;
  int iterations = 0;   ///< of systems solved by fast sums
  double residual = 0;  ///< the largest at a sample, of systems solved by fast sums
  /// Whether the residual exceeds the tolerance, but is at most 1e-6 of the largest |value|.
  bool limited_by_rounding = false;
};

template <int Dim>
struct Interpolation {
  std::vector<std::shared_ptr<const Expansion<Dim>>> components;  ///< one per column of the values
  /// Variances of the difference between a new sample of mean weight and the components. Empty beyond `dense_limit`
  /// samples and if no sample can be left out. Their scale is sigma^2 = mean_k alpha_k e_k, with which the
  /// leave-one-out errors e_k are as large as predicted (Bachoc 2013). For sparse systems it is that of the
  /// (restricted) likelihood, alpha^T s / (n - r), with r coefficients of the polynomial.
  std::vector<std::shared_ptr<const KrigingVariance<Dim>>> variances = {};
  InterpolationReport report;

  /// The components as fields.
  [[nodiscard]] std::vector<std::shared_ptr<const Field<Dim>>> model() const;
};

/// Interpolates, or smooths, by one basis function per sample and a polynomial (thesis eqs. 2.5-2.13): the symmetric
/// positive definite system of a kernel of order 0, or the saddle point system of a conditionally positive definite
/// one, with one factorisation for all components.
///
/// Samples of weight 0 are left out; samples at the same point are replaced by their weighted mean. With degree -2, if
/// the points lie on a line or are fewer than the polynomial has coefficients, it is restricted to what they determine.
/// Constant data give a constant. Results do not depend on the units of points, values and weights.
///
/// Systems are dense, O(n^3), up to 1500 samples, and up to `dense_limit` if the matrix is not sparse. Beyond, compact
/// kernels give sparse systems, solved directly or iteratively depending on size; a chosen support then holds at most
/// about 100 samples, which limits the accuracy. All other kernels are solved by conjugate gradients with fast sums in
/// one to three dimensions: about O(n) in time and memory, a million samples in minutes.
///
/// `metric`: at most one transform, for anisotropic data; periods need a compact kernel.
///
/// Throws InvalidInput for invalid samples, unknown kernels and kernels for other dimensions, a degree below the order
/// minus 1, metrics with a transform per centre, and more than `dense_limit` samples with a kernel that is not compact
/// in more than three dimensions; SolverFailure if the system is singular even with a little smoothing, or too ill
/// conditioned for the tolerance; Cancelled.
template <int Dim>
Interpolation<Dim> interpolate(const Samples<Dim>& samples, const InterpolateOptions& options,
                               const RadialMetric<Dim>& metric);

/// The same with Euclidean distances.
template <int Dim>
Interpolation<Dim> interpolate(const Samples<Dim>& samples, const InterpolateOptions& options = {});

}  // namespace csrbf
