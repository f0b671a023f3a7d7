#pragma once

#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"

namespace csrbf {

/// A partition of unity whose local functions have the given options; what partition_of_unity() does once they are
/// chosen. `places`: only the patches needed to evaluate there are fitted, the others are left undefined. Weights must
/// have the mean 1. Internal.
template <int Dim>
std::shared_ptr<const typename PartitionOfUnity<Dim>::Data> fit_patches(const Samples<Dim>& samples,
                                                                        const LocalOptions& options,
                                                                        const Progress& progress = {},
                                                                        const Points<Dim>* places = nullptr);

/// All patches, of samples sorted by a cover with cells of any size.
template <int Dim>
std::shared_ptr<const typename PartitionOfUnity<Dim>::Data> fit_patches(const Samples<Dim>& samples, Cover<Dim> sorted,
                                                                        const LocalOptions& options,
                                                                        const Progress& progress);

}  // namespace csrbf
