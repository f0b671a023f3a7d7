#pragma once

#include "csrbf/approx/samples/robust_weights.hpp"

namespace csrbf {

/// Makes gross errors of those suspects that a covariance learned from all other samples does not expect: more than
/// eight of its deviations and half the range of the others off. The end of an exponential continues the others, what
/// is wrong does not. All suspects stay where the others are too few to learn from. O(n^3) for n samples, if there are
/// suspects: see RobustWeights.
template <int Dim>
void confirm_errors(const Samples<Dim>& samples, RobustWeights& weights);

}  // namespace csrbf
