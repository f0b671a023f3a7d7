#pragma once

#include <utility>

namespace csrbf {

/// Minimises f on [a, b] by so many steps of golden section.
template <class Function>
double golden_section(const Function& f, double a, double b, int steps) {
  constexpr double ratio = 0.6180339887498949;
  double left = b - ratio * (b - a), right = a + ratio * (b - a);
  double f_left = f(left), f_right = f(right);
  for (int step = 0; step < steps; ++step) {
    if (f_left <= f_right) {
      b = std::exchange(right, left);
      f_right = f_left;
      left = b - ratio * (b - a);
      f_left = f(left);
    } else {
      a = std::exchange(left, right);
      f_left = f_right;
      right = a + ratio * (b - a);
      f_right = f(right);
    }
  }
  return 0.5 * (a + b);
}

}  // namespace csrbf
