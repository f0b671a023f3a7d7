#pragma once

#include "csrbf/approx/global/axis_covariance.hpp"
#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"

#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace csrbf {

/// A fit of many samples by radial functions at some of them, in the coordinates of the samples.
template <int Dim>
struct CenterFit {
  std::vector<std::shared_ptr<const Field<Dim>>> components = {}, variances = {};  ///< see Fit
  std::vector<double> noise = {};  ///< of a sample of weight 1, by component
  AxisCovariance<Dim> covariance;  ///< with the nugget of all samples
  Index centers = 0;
  double error = 0;  ///< root mean square error of samples left out, by generalised cross-validation
};

inline constexpr Index fewest_centers = 200;  // chosen by hand

struct CenterOptions {
  double error_to_beat = std::numeric_limits<double>::infinity();  ///< see CenterFit::error
  double affordable = 1e10;  ///< samples times the square of the number of centres: some seconds; chosen by hand
  bool one_length = false;   ///< for all axes, where the covariance is learned
  Progress progress = {};    ///< stage "solve"
};

/// Predicts a random function of this covariance from all samples, among the functions that m centres span (Smola and
/// Bartlett 2001; the centres of thesis 2.5 with the penalty of one system): samples that are no centres average noise.
/// The nugget is the likeliest for all of them. Centres are the farthest points, as many as keep n m^2 affordable, and
/// fewer where more do not reduce the error. `samples`: distinct points with positive weights. O(n m^2).
/// None where too few centres are affordable, or the matrix is singular by rounding.
template <int Dim>
std::optional<CenterFit<Dim>> fit_at_centers(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance,
                                             const CenterOptions& options = {});

/// The same by a covariance learned from the samples, unless a partition of unity with these options, whose error is
/// `error_to_beat`, predicts up to some thousand of them, left out in turns, clearly better: smooth functions, of which
/// a patch sees few samples. The covariance and the centres are those of all samples. CenterFit::error is that of those
/// left out, of one fold at least.
template <int Dim>
std::optional<CenterFit<Dim>> better_at_centers(const Samples<Dim>& samples, const LocalOptions& patches,
                                                const CenterOptions& options);

}  // namespace csrbf
