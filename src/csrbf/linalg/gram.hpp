#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// The number of rows given to gram() must be a multiple of this, one register of AVX2; pad with zeros.
inline constexpr Index gram_rows = 4;

/// Lower triangle of A = B^T B for the column-major rows x n matrix B; A is n x n, column-major, its upper triangle is
/// not touched. `rows` must be a multiple of gram_rows. For small B, which should fit the first-level cache.
/// O(rows n^2 / 2).
void gram(const double* B, Index rows, Index n, double* A);

/// A = B^T C for the column-major rows x n matrix B and rows x m matrix C; A is n x m, column-major. As above.
void gram(const double* B, Index n, const double* C, Index m, Index rows, double* A);

}  // namespace csrbf
