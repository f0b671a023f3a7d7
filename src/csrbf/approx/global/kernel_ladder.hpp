#pragma once

#include "csrbf/kernels/kernel.hpp"

#include <vector>

namespace csrbf {

/// The kernels that covariances are made of, from rough to smooth.
std::vector<Kernel> kernel_ladder(int dimension);
inline constexpr std::size_t middle_of_ladder = 2;

/// The distances at which kernels are one half.
std::vector<double> half_widths(const std::vector<Kernel>& kernels);

}  // namespace csrbf
