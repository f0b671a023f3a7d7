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
  /// A name of Kernel, or "auto": the kernel with the smallest leave-one-out error (see choose_kernel()); beyond
  /// `dense_limit` samples linear, thin-plate or, up to the plane, cubic, on periodic axes and there in more than three
  /// dimensions a Wendland function.
  std::string kernel = "auto";
  double parameter = std::numeric_limits<double>::quiet_NaN();  ///< of the kernel; NaN: its default

  /// Support radius or length scale sigma in units of the points, 1 / epsilon elsewhere. 0: by leave-one-out; for
  /// kernels without a scale half the largest extent of the data, which only changes the meaning of `smoothing`.
  double support = 0;

  /// lambda >= 0 of A + lambda W^-1 with weights of mean 1 (for kernels of value 1 at 0 the noise variance over that of
  /// the data, roughly); 0 interpolates; empty: chosen from the data, all of them (smoothing_of_many() for fast sums).
  std::optional<double> smoothing = 0;
  LambdaCriterion criterion = LambdaCriterion::leave_one_out;  ///< by which lambda is chosen
  /// Whether weights are used as they are: lambda, and the variances, are for samples of weight 1, also where the
  /// samples are means of several.
  bool keep_weights = false;

  /// Degree of the polynomial: at least the order of the kernel minus 1; -1: none; -2: order - 1, but at least 0.
  int degree = -2;
  /// Whether a degree that the points do not determine is an error; else only what they determine is used.
  bool require_degree = true;

  Index dense_limit = 4000;  ///< largest number of distinct samples for dense systems
  /// Largest residual at a sample, in units of the largest |value|, of systems solved by fast sums; 0: 1e-8, in space
  /// 1e-7.
  double tolerance = 0;
  /// > 0: radial functions only at as few of the samples as it takes for all samples to be within this of the function,
  /// in the unit of the values: greedily where errors are largest (Carr et al. 2001). 0: at all.
  double largest_error = 0;
  Progress progress = {};  ///< stages "choose", "solve"
};

enum class InterpolationSolver { dense, sparse_direct, sparse_iterative, fast_sums };

struct InterpolationReport {
  std::string kernel;    ///< its name
  double support = 0;    ///< used or chosen
  double smoothing = 0;  ///< used or chosen; positive also where rounding made the system singular
  int degree = -1;       ///< of the polynomial
  /// Weighted root mean square of the leave-one-out errors, over all components: exact for dense systems, estimated for
  /// those solved by fast sums and, on neighbourhoods, for sparse ones whose support was chosen; NaN otherwise.
  double leave_one_out = 0;
  double condition = 0;  ///< estimate for dense systems; NaN otherwise
  Index merged = 0;      ///< samples merged with another one at the same point
  InterpolationSolver solver = InterpolationSolver::dense;
  int iterations = 0;   ///< of fast sums
  double residual = 0;  ///< largest one at a sample, of fast sums
  /// Whether it is above the tolerance, but at most 1e-6 of the largest |value|.
  bool limited_by_rounding = false;
};

template <int Dim>
struct Interpolation {
  std::vector<std::shared_ptr<const Expansion<Dim>>> components;  ///< one per column of the values
  /// Of the difference between samples of mean weight and the components; none beyond `dense_limit` samples and
  /// where no sample can be left out. Their scale is sigma^2 = mean_k alpha_k e_k, for which the leave-one-out errors
  /// e_k are as large as predicted (Bachoc 2013); for sparse systems that of the (restricted) likelihood,
  /// alpha^T s / (n - r) with r coefficients of the polynomial.
  std::vector<std::shared_ptr<const KrigingVariance<Dim>>> variances = {};
  InterpolationReport report;

  /// The components as fields.
  [[nodiscard]] std::vector<std::shared_ptr<const Field<Dim>>> model() const;
};

/// Interpolation, or smoothing, by one basis function per sample and a polynomial (thesis eqs. 2.5-2.13): the symmetric
/// positive definite system of a kernel of order 0 or the saddle point system of a conditionally positive definite one,
/// with one factorisation for all components.
///
/// Samples of weight 0 are left out; those at the same point are replaced by their weighted mean. Points on a line, or
/// fewer than the polynomial has coefficients: with degree -2 it is restricted to what the points determine. Constant
/// data give a constant. Results do not depend on the units of points, values and weights.
///
/// Systems are dense, O(n^3), up to 1500 samples, and up to `dense_limit` when the matrix is not sparse. Beyond, those
/// of compact kernels are sparse, solved directly or iteratively depending on size; a chosen support then holds at most
/// about 100 samples, which limits the accuracy. Those of all others are solved by conjugate gradients with fast sums
/// in one to three dimensions (see solve_iteratively()): about O(n) in time and memory, a million samples in minutes.
///
/// `metric`: at most one transform (for anisotropic data); periods need a compact kernel.
///
/// Throws InvalidInput for invalid samples, unknown kernels and kernels for other dimensions, a degree below order - 1,
/// metrics with a transform per centre, and more than `dense_limit` samples with a kernel that is not compact in more
/// than three dimensions; SolverFailure when the system is singular even with a small smoothing, or too ill conditioned
/// for the tolerance.
template <int Dim>
Interpolation<Dim> interpolate(const Samples<Dim>& samples, const InterpolateOptions& options,
                               const RadialMetric<Dim>& metric);

/// The same with Euclidean distances.
template <int Dim>
Interpolation<Dim> interpolate(const Samples<Dim>& samples, const InterpolateOptions& options = {});

}  // namespace csrbf
