#pragma once

#include "figure.hpp"

#include <vector>

namespace csrbf::thesis {

/// What interpolation of n random samples in the unit square costs.
struct Costs {
  double samples = 0;
  double assembly = 0;    ///< s
  double solve = 0;       ///< s
  double evaluation = 0;  ///< s per point
  double nonzeros = 0;    ///< of the matrix, per row
  double factor = 0;      ///< nonzeros of the Cholesky factor, per row
};

/// Wendland's C2 function with a support of three mean distances; the sparse solver of the library.
Costs compact_costs(Index samples);

/// The linear kernel -r: a dense matrix and its LU decomposition.
Costs global_costs(Index samples);

/// The same by fast sums and conjugate gradients (thesis 2.4); `assembly` is that of the sums.
Costs fast_costs(Index samples);

/// Table 2.4, measured.
Figure table_2_4();

}  // namespace csrbf::thesis
