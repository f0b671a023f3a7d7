#pragma once

#include "csrbf/approx/fit_by_method.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"

#include <vector>

namespace csrbf {

/// Adds what samples at the same places say about their noise to the variances of a fit to their means, which knows
/// nothing of it: where a partition of unity was fitted, that of the places around; elsewhere, of few places, that of
/// all, which is the noise of the report too. Nothing without replicates. `places`: the places in the coordinates of
/// the fit; `place`: that of each sample, counted in the order in which they appear; see merge_duplicates().
template <int Dim>
void add_replicate_noise(const Samples<Dim>& samples, const std::vector<Index>& place, const Replicates& replicates,
                         const Points<Dim>& places, MethodFields<Dim>& fields);

}  // namespace csrbf
