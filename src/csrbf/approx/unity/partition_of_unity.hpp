#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace csrbf {

template <int Dim>
struct PartitionOfUnityData;

/// The local functions of a partition of unity: polynomials of a degree plus CSRBF sums.
struct LocalOptions {
  std::string kernel = "wendland-c4";
  double support = 4;  ///< of the kernel, in units of the radius of a patch
  int degree = 2;      ///< -1: no polynomial
  Index samples = 40;  ///< a patch is fitted to this many samples
  Index centers = 40;  ///< radial functions per patch, centred at samples spread over it; `samples`: at all of them
  /// 0: distances are Euclidean. Up to 1: those across the direction in which the samples of a patch lie, as on a track
  /// of soundings, are stretched, for 1 until the samples spread evenly. For radial functions only.
  double anisotropy = 0;
  double smoothing = 0;  ///< lambda: sum_k w_k (f - s)^2 + lambda alpha^T A alpha is minimised

  bool operator==(const LocalOptions&) const = default;
};

struct PartitionOfUnityOptions {
  /// Of the local functions; what is not given is chosen by cross-validation.
  std::optional<std::string> kernel = {};
  std::optional<int> degree = {};
  std::optional<Index> samples_per_patch = {};
  std::optional<Index> centers_per_patch = {};
  std::optional<double> anisotropy = {};
  std::optional<double> smoothing = {};
  /// Mean error, in the unit of the values, below which more accuracy is not worth any time; 0: 1e-10 of their range.
  double accuracy = 0;
  Progress progress = {};
};

struct PartitionOfUnityReport {
  LocalOptions local;
  Index patches = 0;
  Index centers = 0;                 ///< of all patches
  double cross_validation_rmse = 0;  ///< of samples predicted by patches fitted without them
};

/// One field per component of the values, all on the same cover.
template <int Dim>
struct PartitionOfUnityFit {
  std::shared_ptr<const PartitionOfUnityData<Dim>> data;
  PartitionOfUnityReport report;

  [[nodiscard]] std::vector<std::shared_ptr<const Field<Dim>>> fields() const;
};

/// Approximates samples by a partition of unity. For exact values it nearly interpolates, as each local function
/// interpolates the samples it is fitted to. O(n log n) time, O(n) memory. Samples at the same point must have been
/// merged; those of weight 0 are left out. Results do not depend on the units of points, values and weights.
/// Throws InvalidInput for invalid samples (see require_valid) and options: kernels must be positive definite, degrees
/// -1 to 8.
template <int Dim>
PartitionOfUnityFit<Dim> partition_of_unity(const Samples<Dim>& samples, const PartitionOfUnityOptions& options = {});

}  // namespace csrbf
