#include "csrbf/approx/global/kernel_ladder.hpp"

namespace csrbf {

std::vector<Kernel> kernel_ladder(int dimension) {
  std::vector<Kernel> kernels = {Kernel("powered-exponential", dimension, 0.7)};
  for (const char* name : {"matern-c0", "matern-c2", "matern-c4", "matern-c6", "inverse-multiquadric", "gaussian"})
    kernels.emplace_back(name, dimension);
  return kernels;
}

std::vector<double> half_widths(const std::vector<Kernel>& kernels) {
  std::vector<double> widths;
  for (const Kernel& kernel : kernels) {
    double lo = 0, hi = 1;
    while (kernel.value(hi) > .5) hi *= 2;
    for (int k = 0; k < 50; ++k) (kernel.value(.5 * (lo + hi)) > .5 ? lo : hi) = .5 * (lo + hi);
    widths.push_back(hi);
  }
  return widths;
}

}  // namespace csrbf
