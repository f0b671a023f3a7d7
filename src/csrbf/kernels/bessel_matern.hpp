#pragma once

#include "csrbf/kernels/radial_function.hpp"

#include <memory>

namespace csrbf {

/// The Matern function 2^(1 - nu) / Gamma(nu) r^nu K_nu(r) for any 0 < nu <= 50, by Bessel functions: about a hundred
/// times slower than the closed forms for half-integer nu.
std::shared_ptr<const RadialFunction> bessel_matern_function(double nu);

}  // namespace csrbf
