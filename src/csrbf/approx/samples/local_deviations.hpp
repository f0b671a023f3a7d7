#pragma once

#include "csrbf/approx/samples/samples.hpp"

namespace csrbf {

/// Samples that a local fit of local_deviations() is made of.
template <int Dim>
constexpr Index local_neighbors = 4 * (Dim + 1) + 4;

/// How far each of the samples `targets` is from what the samples around it say: the difference to a robust local
/// linear fit to them, without it, in units of the differences of those, larger ones for samples of less weight and
/// beside all others; the largest over the components. At most about 5 for nearly all samples of a function with noise
/// of one distribution, whatever its size; 0 where the samples around it say nothing. Samples that others nearby agree
/// with, as along a step, count as those do. Several samples may be at one point; those of weight 0 are ignored, and
/// have 0. O(log n) each.
template <int Dim>
Eigen::VectorXd local_deviations(const Samples<Dim>& samples, const std::vector<Index>& targets);

}  // namespace csrbf
