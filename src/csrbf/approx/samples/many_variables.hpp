#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// The dimension in which functions of so many variables are fitted: their own, or most_variables with zeros for those
/// that there are not. A coordinate that is the same for all samples has no influence: it has no distances, no slope,
/// and no length to be learned.
constexpr Index fitted_dimension(Index variables) {
  return variables <= largest_dimension || variables > most_variables ? variables : most_variables;
}

/// Points (at most Dim x n) with zeros for the other variables.
template <int Dim>
Points<Dim> with_zeros(const Eigen::Ref<const Eigen::MatrixXd>& x) {
  Points<Dim> result = Points<Dim>::Zero(Dim, x.cols());
  result.topRows(x.rows()) = x;
  return result;
}

}  // namespace csrbf
