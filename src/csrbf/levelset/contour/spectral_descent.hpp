#pragma once

#include <functional>
#include <vector>

namespace csrbf {

/// A function of x and its derivatives, x.size() of each.
using DescentEnergy = std::function<double(const float* x, float* derivatives)>;

struct DescentOptions {
  float limit = 1;          ///< |x_i| stays at most that, or gets no larger
  double rate = 1;          ///< of the first step: what the derivatives are multiplied by
  int iterations = 100;     ///< evaluations of the energy at most
  double tolerance = 1e-3;  ///< ends when a step lowers the energy by less than this times the decrease so far
};

/// Lowers a function by the spectral projected gradient method (Birgin, Martinez and Raydan 2000), monotone: with
/// back-tracking no step raises it. Appends the energy at the start and after each step to `energies`; returns the
/// evaluations used. The same bits for every number of threads.
int spectral_descent(const DescentEnergy& energy, const DescentOptions& options, std::vector<float>& x,
                     std::vector<double>& energies);

}  // namespace csrbf
