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

/// The local functions of a partition of unity: polynomials plus sums of CSRBFs.
struct LocalOptions {
  std::string kernel = "wendland-c4";
  double support = 4;  ///< of the kernel, in patch radii
  int degree = 2;      ///< -1: no polynomial
  Index samples = 40;  ///< number of samples that a patch is fitted to
  Index centers = 40;  ///< radial functions per patch, at samples spread over it; equal to `samples`: at all
  /// 0: Euclidean distances. Up to 1: distances across the direction in which the samples of a patch lie, such as a
  /// track of soundings, are stretched; at 1 until the samples spread evenly. For radial functions only.
  double anisotropy = 0;
  double smoothing = 0;  ///< lambda in sum_k w_k (f - s)^2 + lambda alpha^T A alpha, which is minimised

  bool operator==(const LocalOptions&) const = default;
};

struct PartitionOfUnityOptions {
  /// Options of the local functions, see LocalOptions; those not given are chosen by cross-validation.
  std::optional<std::string> kernel = {};
  std::optional<int> degree = {};
  std::optional<Index> samples_per_patch = {};
  std::optional<Index> centers_per_patch = {};
  std::optional<double> anisotropy = {};
  std::optional<double> smoothing = {};
  /// Mean error at which to stop looking for more accuracy, in the unit of the values; 0: 1e-10 of their range.
  double accuracy = 0;
  Progress progress = {};
};

struct PartitionOfUnityReport {
  LocalOptions local;
  Index patches = 0;
  Index centers = 0;                 ///< of all patches together
  double cross_validation_rmse = 0;  ///< of samples predicted by patches fitted without them
};

/// One field per component of the values, all on the same cover.
template <int Dim>
struct PartitionOfUnityFit {
  std::shared_ptr<const PartitionOfUnityData<Dim>> data;
  PartitionOfUnityReport report;

  [[nodiscard]] std::vector<std::shared_ptr<const Field<Dim>>> fields() const;
};

/// Approximates samples by a partition of unity. It nearly interpolates exact values, because each local function
/// interpolates the samples that it is fitted to. Samples at the same point must have been merged; those of weight 0
/// are ignored. Results do not depend on the units of points, values and weights. O(n log n) time, O(n) memory. Throws
/// InvalidInput for invalid samples (see require_valid()) and options: kernels must be positive definite, degrees -1 to
/// 8; Cancelled.
template <int Dim>
PartitionOfUnityFit<Dim> partition_of_unity(const Samples<Dim>& samples, const PartitionOfUnityOptions& options = {});

}  // namespace csrbf
