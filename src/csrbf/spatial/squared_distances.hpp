#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// |x_i - y|^2 of n points, one after the other in memory. As an expression of matrices it would take the compiler
/// seconds in every file, for six dimensions.
template <int Dim>
void squared_distances(const double* x, Index n, const Point<Dim>& y, double* out) {
  for (Index i = 0; i < n; ++i) {
    double sum = 0;
    for (int a = 0; a < Dim; ++a) {
      const double d = x[Dim * i + a] - y[a];
      sum += d * d;
    }
    out[i] = sum;
  }
}

}  // namespace csrbf
