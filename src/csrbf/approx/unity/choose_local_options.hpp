#pragma once

#include "csrbf/approx/unity/cover.hpp"
#include "csrbf/approx/unity/partition_of_unity.hpp"

namespace csrbf {

/// Options of the local functions of a partition of unity and their cross-validation errors.
struct ChosenLocalOptions {
  LocalOptions options;
  /// Mean absolute error of samples predicted by patches fitted without them, over all components.
  double error = 0;
  double rmse = 0;  ///< their root mean square error
};

/// Chooses kernel, degree, number of samples and centres per patch and smoothing by leave-one-out cross-validation of
/// some patches spread over the samples. Apart from placing the patches, its time does not depend on the number of
/// samples.
template <int Dim>
ChosenLocalOptions choose_local_options(const Samples<Dim>& samples, const PartitionOfUnityOptions& given);

/// The same for samples that are already sorted, see cover_to_choose_by(), and weights of mean 1.
template <int Dim>
ChosenLocalOptions choose_local_options(const Samples<Dim>& samples, const Cover<Dim>& cover,
                                        const PartitionOfUnityOptions& given);

/// Cells of a few samples each, among which patches are placed.
template <int Dim>
Cover<Dim> cover_to_choose_by(const Samples<Dim>& samples);

}  // namespace csrbf
