#pragma once

#include "csrbf/core/error.hpp"
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

/// The same for columns of a matrix, whose dimension is one of CSRBF_FOR_MANY_DIMS known at run time, from `first` on.
inline void squared_distances(const Eigen::MatrixXd& points, Index first, const double* y, double* out) {
  const double* x = points.data() + points.rows() * first;
  switch (points.rows()) {
#define CSRBF_CASE(Dim) \
  case Dim:             \
    return squared_distances<Dim>(x, points.cols() - first, Point<Dim>(y), out);
    CSRBF_FOR_MANY_DIMS(CSRBF_CASE)
#undef CSRBF_CASE
    default:
      throw InvalidInput("squared_distances: dimension: unsupported");
  }
}

}  // namespace csrbf
