#pragma once

#include "csrbf/core/types.hpp"

#include <optional>

namespace csrbf {

/// The size beyond which sizes are of another origin than most of them, such as errors; none where they may be the tail
/// of one distribution.
///
/// For all usual distributions, from the normal to Student's with few degrees of freedom, the logarithm of the share of
/// sizes beyond x is concave as a function of log x: the tail falls at least as fast as a power of x whose exponent is
/// that of the sizes next to it. Where a wide range of x holds significantly fewer sizes than that (a binomial test),
/// those beyond are others. They begin at the widest spacing in that range. At most a fifth of all are. `sizes`: not
/// negative. O(n log n).
std::optional<double> separate_tail(const Eigen::Ref<const Eigen::VectorXd>& sizes);

}  // namespace csrbf
