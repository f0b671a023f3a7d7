#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/approx/unity/local_options.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace csrbf {

template <int Dim>
struct PartitionOfUnityData;

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
