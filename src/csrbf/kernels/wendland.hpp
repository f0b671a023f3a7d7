#pragma once

#include "csrbf/kernels/radial_function.hpp"

#include <memory>

namespace csrbf {

/// Wendland's compactly supported function phi_{d,k} (Wendland 1995; thesis section 2.2): phi(0) = 1, phi(r) = 0 for
/// r >= 1, C^{2k}, positive definite on R^d. For even d it is the function of d + 1.
///
/// All are closed forms without cancellation near r = 1 and, for k >= 1, valid at r = 0, where q = 0. For k = 0 neither
/// derivative exists at the centre: g and h are 0 there by convention, as is h for k = 1.
///
/// `smoothness`: k = 0, 1, 2 or 3. About one square root per point in up to 7 dimensions.
std::shared_ptr<const RadialFunction> wendland_function(int dimension, int smoothness);

}  // namespace csrbf
