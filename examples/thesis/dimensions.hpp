#pragma once

#include "figure.hpp"

#include <string>
#include <vector>

namespace csrbf::thesis {

/// One method on n random samples of a smooth function on the unit cube of a dimension.
struct DimensionResult {
  int dimension = 0;
  double samples = 0;
  double rmse = 0;     ///< at 2000 random points, over the standard deviation of the function
  double seconds = 0;  ///< fit
};

/// The default fit, or `method` of FitOptions; "nearest": the value of the nearest sample.
template <int Dim>
DimensionResult fit_dimension(const std::string& method, Index samples);

/// The methods in three to six dimensions.
Figure dimensions();

}  // namespace csrbf::thesis
