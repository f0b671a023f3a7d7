#pragma once

#include "csrbf/kernels/radial_function.hpp"

#include <memory>

namespace csrbf {

/// exp(-r^2).
std::shared_ptr<const RadialFunction> gaussian_function();

/// exp(-r^exponent), 0 < exponent <= 2.
std::shared_ptr<const RadialFunction> powered_exponential_function(double exponent);

/// The Matern function of order nu > 0, normalised to 1 at 0.
std::shared_ptr<const RadialFunction> matern_function(double nu);

/// The same for any 0 < nu <= 50, 2^(1 - nu) / Gamma(nu) r^nu K_nu(r), by Bessel functions: about a hundred times
/// slower than the closed forms for half-integer nu.
std::shared_ptr<const RadialFunction> bessel_matern_function(double nu);

/// (1 + r^2)^exponent for a negative exponent, (-1)^ceil(exponent) times that for a positive one.
std::shared_ptr<const RadialFunction> multiquadric_function(double exponent);

/// (-1)^ceil(exponent/2) r^exponent, or (-1)^(exponent/2 + 1) r^exponent log r when the exponent is even.
std::shared_ptr<const RadialFunction> polyharmonic_function(double exponent);

}  // namespace csrbf
