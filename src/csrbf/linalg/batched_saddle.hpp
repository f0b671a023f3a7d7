#pragma once

#include "csrbf/linalg/batched_cholesky.hpp"

namespace csrbf {

/// Eight saddle point systems of one size, in the layout of batched_cholesky.hpp and in place on the caller's memory.
struct BatchSaddle {
  Index n = 0;      ///< rows of A
  Index Q = 0;      ///< columns of G, at most n
  Index count = 1;  ///< right-hand sides per lane

  double* A = nullptr;     ///< batch_matrix_size(n), lower triangles; overwritten
  double* G = nullptr;     ///< entry (i, q) of lane s at G[8 * (q * n + i) + s]; overwritten
  double* s = nullptr;     ///< `count` right-hand sides of n blocks of eight; replaced by the solutions alpha
  double* pi = nullptr;    ///< receives `count` times Q blocks of eight
  double* work = nullptr;  ///< batch_saddle_work(n) doubles
};

/// Doubles of work space.
constexpr Index batch_saddle_work(Index n) {
  return batch_matrix_size(n) + 2 * batch_lanes * n;
}

/// Solves, like solve_saddle() for a single system,
///
///     [ A    G ] [ alpha ]   [ s ]
///     [ G^T  0 ] [ pi    ] = [ 0 ]
///
/// by a QR decomposition of G and the Cholesky factor of A on the null space of G^T. O(n^3 / 3 + 4 n^2 Q + count n^2).
/// Returns the lanes that failed, whose results are meaningless: the columns of G are linearly dependent, or A is not
/// positive definite on the null space to working precision.
BatchMask batch_saddle(const BatchSaddle& system);

}  // namespace csrbf
