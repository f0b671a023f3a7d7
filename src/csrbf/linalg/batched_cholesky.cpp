#include "csrbf/linalg/batched_cholesky.hpp"

#include "csrbf/core/simd.hpp"

#include <cstring>
#include <numeric>

namespace csrbf {
namespace {

// Lanes are taken four at a time: a tile of 3 x 3 entries then fills the 16 registers of AVX2, and each entry loaded is
// used three times.
constexpr int width = 4;
constexpr int tile = 3;
using Lanes = double __attribute__((vector_size(width * sizeof(double))));

CSRBF_ALWAYS_INLINE void load(Lanes& x, const double* from) {
  std::memcpy(&x, from, sizeof x);
}
CSRBF_ALWAYS_INLINE void store(const Lanes& x, double* to) {
  std::memcpy(to, &x, sizeof x);
}

template <int R, int C>
using Tile = Lanes[R][C];

// S -= sum_{k < depth} rows[r][k] cols[c][k].
template <int R, int C>
CSRBF_ALWAYS_INLINE void subtract_products(const double* const (&rows)[R], const double* const (&cols)[C], Index depth,
                                           Tile<R, C>& S) {
  for (Index k = 0; k < batch_lanes * depth; k += batch_lanes) {
    Lanes a[R];
    Lanes b[C];
#pragma GCC unroll 3
    for (int r = 0; r < R; ++r) load(a[r], rows[r] + k);
#pragma GCC unroll 3
    for (int c = 0; c < C; ++c) load(b[c], cols[c] + k);
#pragma GCC unroll 3
    for (int r = 0; r < R; ++r) {
#pragma GCC unroll 3
      for (int c = 0; c < C; ++c) S[r][c] -= a[r] * b[c];
    }
  }
}

// Entries (r, 0..C-1) of R rows of the solution X of X L_JJ^T = S, column block J of C columns starting at column j.
template <int R, int C>
CSRBF_ALWAYS_INLINE void eliminate(double* const (&rows)[R], const double* const (&cols)[C], Index j) {
  for (int half = 0; half < batch_lanes; half += width) {
    Tile<R, C> S;
    const double* from[R];
    const double* against[C];
#pragma GCC unroll 3
    for (int r = 0; r < R; ++r) from[r] = rows[r] + half;
#pragma GCC unroll 3
    for (int c = 0; c < C; ++c) against[c] = cols[c] + half;
#pragma GCC unroll 3
    for (int r = 0; r < R; ++r) {
#pragma GCC unroll 3
      for (int c = 0; c < C; ++c) load(S[r][c], from[r] + batch_lanes * (j + c));
    }
    subtract_products<R, C>(from, against, j, S);
#pragma GCC unroll 3
    for (int c = 0; c < C; ++c) {
#pragma GCC unroll 3
      for (int b = 0; b < c; ++b) {
        Lanes l;
        load(l, against[c] + batch_lanes * (j + b));
#pragma GCC unroll 3
        for (int r = 0; r < R; ++r) S[r][c] -= S[r][b] * l;
      }
      Lanes reciprocal;
      load(reciprocal, against[c] + batch_lanes * (j + c));
#pragma GCC unroll 3
      for (int r = 0; r < R; ++r) {
        S[r][c] *= reciprocal;
        store(S[r][c], rows[r] + half + batch_lanes * (j + c));
      }
    }
  }
}

// 1 / sqrt(pivot) where it is above its threshold; elsewhere 0, and a mark in `failed`.
CSRBF_ALWAYS_INLINE void invert_pivots(const Lanes& pivot, const Lanes& threshold, Lanes& reciprocal, Lanes& failed) {
  const Lanes none = {};
  const Lanes one = none + 1;
  Lanes root;
  for (int s = 0; s < width; ++s) root[s] = std::sqrt(pivot[s]);
  reciprocal = pivot > threshold ? one / root : none;
  failed = pivot > threshold ? failed : one;
}

// The Cholesky factor of the diagonal block of R rows starting at row i, the rows to the left of it being done.
template <int R>
CSRBF_ALWAYS_INLINE void factorise(double* const (&rows)[R], Index i, double tolerance, double* failed) {
  for (int half = 0; half < batch_lanes; half += width) {
    Tile<R, R> S = {};
    Lanes threshold[R];
    Lanes marks;
    const double* from[R];
    load(marks, failed + half);
#pragma GCC unroll 3
    for (int r = 0; r < R; ++r) {
      from[r] = rows[r] + half;
#pragma GCC unroll 3
      for (int c = 0; c <= r; ++c) load(S[r][c], from[r] + batch_lanes * (i + c));
      threshold[r] = tolerance * S[r][r];
    }
    subtract_products<R, R>(from, from, i, S);
#pragma GCC unroll 3
    for (int c = 0; c < R; ++c) {
      Lanes reciprocal;
      invert_pivots(S[c][c], threshold[c], reciprocal, marks);
      store(reciprocal, rows[c] + half + batch_lanes * (i + c));
#pragma GCC unroll 3
      for (int r = c + 1; r < R; ++r) {
        S[r][c] *= reciprocal;
        store(S[r][c], rows[r] + half + batch_lanes * (i + c));
#pragma GCC unroll 3
        for (int b = c + 1; b <= r; ++b) S[r][b] -= S[r][c] * S[b][c];
      }
    }
    store(marks, failed + half);
  }
}

// Rows i, ..., i + R - 1 of the factor, from those above.
template <int R>
CSRBF_ALWAYS_INLINE void factorise_rows(double* A, Index i, double tolerance, double* failed) {
  double* rows[R];
  for (int r = 0; r < R; ++r) rows[r] = A + batch_entry(i + r, 0);
  for (Index j = 0; j < i; j += tile) {
    const double* const cols[tile] = {A + batch_entry(j, 0), A + batch_entry(j + 1, 0), A + batch_entry(j + 2, 0)};
    eliminate<R, tile>(rows, cols, j);
  }
  factorise<R>(rows, i, tolerance, failed);
}

CSRBF_SIMD_CLONES void factorise(double* A, Index n, double tolerance, double* failed) {
  Index i = 0;
  for (; i + tile <= n; i += tile) factorise_rows<tile>(A, i, tolerance, failed);
  if (n - i == 2) factorise_rows<2>(A, i, tolerance, failed);
  if (n - i == 1) factorise_rows<1>(A, i, tolerance, failed);
}

// Column block J of L^T x = y, the unknowns after it being done: solves for x_J and takes it out of the rows before.
template <int R, int C>
CSRBF_ALWAYS_INLINE void substitute_back(const double* L, Index j, double* const (&rows)[R]) {
  for (int half = 0; half < batch_lanes; half += width) {
    Tile<R, C> X;
    const double* cols[C];
#pragma GCC unroll 3
    for (int c = 0; c < C; ++c) cols[c] = L + batch_entry(j + c, 0) + half;
#pragma GCC unroll 3
    for (int c = C - 1; c >= 0; --c) {
      Lanes reciprocal;
      load(reciprocal, cols[c] + batch_lanes * (j + c));
#pragma GCC unroll 3
      for (int r = 0; r < R; ++r) {
        load(X[r][c], rows[r] + half + batch_lanes * (j + c));
#pragma GCC unroll 3
        for (int b = C - 1; b > c; --b) {
          Lanes l;
          load(l, cols[b] + batch_lanes * (j + c));
          X[r][c] -= X[r][b] * l;
        }
        X[r][c] *= reciprocal;
        store(X[r][c], rows[r] + half + batch_lanes * (j + c));
      }
    }
    for (Index i = 0; i < batch_lanes * j; i += batch_lanes) {
      Lanes l[C];
#pragma GCC unroll 3
      for (int c = 0; c < C; ++c) load(l[c], cols[c] + i);
#pragma GCC unroll 3
      for (int r = 0; r < R; ++r) {
        Lanes y;
        load(y, rows[r] + half + i);
#pragma GCC unroll 3
        for (int c = 0; c < C; ++c) y -= l[c] * X[r][c];
        store(y, rows[r] + half + i);
      }
    }
  }
}

template <int R, int C>
CSRBF_ALWAYS_INLINE void substitute(const double* L, Index j, double* const (&rows)[R]) {
  const double* cols[C];
  for (int c = 0; c < C; ++c) cols[c] = L + batch_entry(j + c, 0);
  eliminate<R, C>(rows, cols, j);
}

// R right-hand sides, forwards and backwards.
template <int R>
CSRBF_ALWAYS_INLINE void solve_rows(const double* L, Index n, double* b) {
  double* rows[R];
  for (int r = 0; r < R; ++r) rows[r] = b + batch_lanes * n * r;
  const Index full = n - n % tile;
  for (Index j = 0; j < full; j += tile) substitute<R, tile>(L, j, rows);
  if (n - full == 1) substitute<R, 1>(L, full, rows), substitute_back<R, 1>(L, full, rows);
  if (n - full == 2) substitute<R, 2>(L, full, rows), substitute_back<R, 2>(L, full, rows);
  for (Index j = full - tile; j >= 0; j -= tile) substitute_back<R, tile>(L, j, rows);
}

CSRBF_SIMD_CLONES void solve(const double* L, Index n, double* b, Index count) {
  Index r = 0;
  for (; r + tile <= count; r += tile) solve_rows<tile>(L, n, b + batch_lanes * n * r);
  if (count - r == 2) solve_rows<2>(L, n, b + batch_lanes * n * r);
  if (count - r == 1) solve_rows<1>(L, n, b + batch_lanes * n * r);
}

// Entries (i + r, j + c) of A += F^T F; only c <= r are stored when the block is on the diagonal.
template <int R, int C>
CSRBF_ALWAYS_INLINE void gram_tile(const double* F, Index rows, Index n, Index i, Index j, double* A) {
  for (int half = 0; half < batch_lanes; half += width) {
    Tile<R, C> S = {};
    for (Index k = 0; k < rows; ++k) {
      const double* row = F + batch_lanes * n * k + half;
      Lanes a[R];
      Lanes b[C];
#pragma GCC unroll 3
      for (int r = 0; r < R; ++r) load(a[r], row + batch_lanes * (i + r));
#pragma GCC unroll 3
      for (int c = 0; c < C; ++c) load(b[c], row + batch_lanes * (j + c));
#pragma GCC unroll 3
      for (int r = 0; r < R; ++r) {
#pragma GCC unroll 3
        for (int c = 0; c < C; ++c) S[r][c] += a[r] * b[c];
      }
    }
#pragma GCC unroll 3
    for (int r = 0; r < R; ++r) {
#pragma GCC unroll 3
      for (int c = 0; c < C; ++c) {
        if (i == j && c > r) continue;
        double* to = A + batch_entry(i + r, j + c) + half;
        Lanes sum;
        load(sum, to);
        sum += S[r][c];
        store(sum, to);
      }
    }
  }
}

template <int R>
CSRBF_ALWAYS_INLINE void gram_rows(const double* F, Index rows, Index n, Index i, double* A) {
  for (Index j = 0; j < i; j += tile) gram_tile<R, tile>(F, rows, n, i, j, A);
  gram_tile<R, R>(F, rows, n, i, i, A);
}

CSRBF_SIMD_CLONES void gram(const double* F, Index rows, Index n, double* A) {
  Index i = 0;
  for (; i + tile <= n; i += tile) gram_rows<tile>(F, rows, n, i, A);
  if (n - i == 2) gram_rows<2>(F, rows, n, i, A);
  if (n - i == 1) gram_rows<1>(F, rows, n, i, A);
}

}  // namespace

void batch_gram(const double* F, Index rows, Index n, double* A) {
  // As many rows at a time as stay close while all pairs of their entries are visited: 64 KB, and no more than the
  // eight ways of the first-level cache hold when the length of a row shares powers of two with its 64 sets.
  constexpr Index kept = 65536 / (batch_lanes * sizeof(double));
  constexpr Index sets = 64;
  constexpr Index ways = 6;  // two are left for A
  const Index chunk = std::max<Index>(4, std::min(kept / std::max<Index>(n, 1), ways * sets / std::gcd(n, sets)));
  for (Index k = 0; k < rows; k += chunk) gram(F + batch_lanes * n * k, std::min(chunk, rows - k), n, A);
}

BatchMask batch_cholesky(double* A, Index n, double tolerance) {
  double failed[batch_lanes] = {};
  factorise(A, n, tolerance, failed);
  BatchMask mask = 0;
  for (int s = 0; s < batch_lanes; ++s) mask |= static_cast<BatchMask>(failed[s] != 0) << s;
  return mask;
}

void batch_solve(const double* L, Index n, double* b, Index count) {
  solve(L, n, b, count);
}

void batch_pad(double* A, Index n, int lane, Index size) {
  for (Index i = size; i < n; ++i)
    for (Index j = 0; j <= i; ++j) A[batch_entry(i, j) + lane] = i == j ? 1 : 0;
}

}  // namespace csrbf
