#pragma once

#include "figure.hpp"

#include <vector>

namespace csrbf::thesis {

/// One interpolant of 41 samples of the signal (3.5) at equal distances.
struct SupportSize {
  double support = 0;    ///< in sample distances
  double rmse = 0;       ///< between the samples
  double midpoint = 0;   ///< mean of |f| over mean of |s| halfway between samples: 0 when f collapses
  double density = 0;    ///< share of the matrix that is not 0
  double condition = 0;  ///< of the matrix
};

/// Fig. 2.4: what too small and too large supports of Wendland's C2 function do.
std::vector<SupportSize> support_sizes(const std::vector<double>& supports);

Figure figure_2_4();

}  // namespace csrbf::thesis
