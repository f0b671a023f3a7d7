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

/// The same for columns of a matrix, whose dimension is known at run time, from `first` on.
inline void squared_distances(const Eigen::MatrixXd& points, Index first, const double* y, double* out) {
  const Index dimension = points.rows(), n = points.cols() - first;
  const double* x = points.data() + dimension * first;
  switch (dimension) {
    case 1:
      return squared_distances<1>(x, n, Point<1>(y), out);
    case 2:
      return squared_distances<2>(x, n, Point<2>(y), out);
    case 3:
      return squared_distances<3>(x, n, Point<3>(y), out);
    default:
      for (Index i = 0; i < n; ++i) {
        double sum = 0;
        for (Index a = 0; a < dimension; ++a) {
          const double d = x[dimension * i + a] - y[a];
          sum += d * d;
        }
        out[i] = sum;
      }
  }
}

}  // namespace csrbf
