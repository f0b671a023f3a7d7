#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// Small dense symmetric positive definite systems, solved eight at a time: system = lane of every operation. All have
/// the same size n; smaller ones are padded with the identity. Everything works in place on the caller's memory, which
/// needs no alignment beyond that of double.
///
/// * A matrix is its lower triangle by rows: entry (i, j), j <= i, of lane s is at `batch_entry(i, j) + s`.
/// * A right-hand side or solution is n blocks of eight: component i of lane s is at `8 * i + s`: the place of one
///   more row of the triangle, so that normal equations can be gathered with the data as last column, see `batch_gram`.
inline constexpr int batch_lanes = 8;

/// Offset of entry (i, j), j <= i, of lane 0.
constexpr Index batch_entry(Index i, Index j) {
  return batch_lanes * (i * (i + 1) / 2 + j);
}

/// Doubles in a batch of n x n matrices.
constexpr Index batch_matrix_size(Index n) {
  return batch_entry(n, 0);
}

/// Bit s is set when lane s is meant.
using BatchMask = unsigned;

/// A += F^T F for every lane: `rows` rows of n entries, entry (k, i) of lane s at F[8 * (k * n + i) + s]. O(rows n^2).
/// With the weighted data as entry n - 1 of each row, row n - 1 of A becomes the right-hand side of the normal
/// equations of the n - 1 others, followed by the sum of squares of the data.
void batch_gram(const double* F, Index rows, Index n, double* A);

/// Replaces A by its Cholesky factor L, with the reciprocals of its diagonal on the diagonal. O(n^3 / 3).
///
/// A pivot that is not above `tolerance` times the diagonal entry of A it came from has failed. Its unknown is left
/// out: solutions have 0 there, and elsewhere the solution of the system without it. Returns the lanes with failed
/// pivots; others are not affected by them.
BatchMask batch_cholesky(double* A, Index n, double tolerance = 0);

/// Solves L L^T x = b for `count` right-hand sides per lane, each followed by the next, in place. O(count n^2).
void batch_solve(const double* L, Index n, double* b, Index count = 1);

}  // namespace csrbf
