#pragma once

#include "csrbf/kernels/radial_function.hpp"

#include <memory>

namespace csrbf {

/// Schaback's missing Wendland function of H^2(R^2).
std::shared_ptr<const RadialFunction> missing_wendland_function();

/// The Wu function psi_{k,l} with `derivatives` continuous derivatives (0, 2, 4, 6) for the dimension: the one of
/// smallest k that is positive definite there. Null when there is none.
std::shared_ptr<const RadialFunction> wu_function(int dimension, int derivatives);

/// The Buhmann function with `derivatives` continuous derivatives (1, 2, 3).
std::shared_ptr<const RadialFunction> buhmann_function(int derivatives);

}  // namespace csrbf
