#include "csrbf/linalg/batched_cholesky.hpp"

#include "csrbf/core/simd.hpp"

#include <cstring>
#include <numeric>

namespace csrbf {
namespace {

// How many lanes are taken at a time, and the side of the square of entries that is kept in registers meanwhile, where
// each entry loaded is used as often. The 16 registers of AVX2 hold 3 x 3 entries of four lanes, the 32 of AVX-512
// 4 x 4 of all eight.
struct Narrow {
  static constexpr int width = 4, tile = 3;
  using Lanes = double __attribute__((vector_size(width * sizeof(double))));
};
struct Wide {
  static constexpr int width = 8, tile = 4;
  using Lanes = double __attribute__((vector_size(width * sizeof(double))));
};

template <class W>
using Lanes = typename W::Lanes;

template <class L>
CSRBF_ALWAYS_INLINE void load(L& x, const double* from) {
  std::memcpy(&x, from, sizeof x);
}
template <class L>
CSRBF_ALWAYS_INLINE void store(const L& x, double* to) {
  std::memcpy(to, &x, sizeof x);
}

template <class W, int R, int C>
using Tile = Lanes<W>[R][C];

// S -= sum_{k < depth} rows[r][k] cols[c][k].
template <class W, int R, int C>
CSRBF_ALWAYS_INLINE void subtract_products(const double* const (&rows)[R], const double* const (&cols)[C], Index depth,
                                           Tile<W, R, C>& S) {
  for (Index k = 0; k < batch_lanes * depth; k += batch_lanes) {
    Lanes<W> a[R];
    Lanes<W> b[C];
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) load(a[r], rows[r] + k);
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) load(b[c], cols[c] + k);
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) {
#pragma GCC unroll 4
      for (int c = 0; c < C; ++c) S[r][c] -= a[r] * b[c];
    }
  }
}

// Entries (r, 0..C-1) of R rows of the solution X of X L_JJ^T = S, column block J of C columns starting at column j.
template <class W, int R, int C>
CSRBF_ALWAYS_INLINE void eliminate(double* const (&rows)[R], const double* const (&cols)[C], Index j) {
  for (int half = 0; half < batch_lanes; half += W::width) {
    Tile<W, R, C> S;
    const double* from[R];
    const double* against[C];
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) from[r] = rows[r] + half;
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) against[c] = cols[c] + half;
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) {
#pragma GCC unroll 4
      for (int c = 0; c < C; ++c) load(S[r][c], from[r] + batch_lanes * (j + c));
    }
    subtract_products<W, R, C>(from, against, j, S);
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) {
#pragma GCC unroll 4
      for (int b = 0; b < c; ++b) {
        Lanes<W> l;
        load(l, against[c] + batch_lanes * (j + b));
#pragma GCC unroll 4
        for (int r = 0; r < R; ++r) S[r][c] -= S[r][b] * l;
      }
      Lanes<W> reciprocal;
      load(reciprocal, against[c] + batch_lanes * (j + c));
#pragma GCC unroll 4
      for (int r = 0; r < R; ++r) {
        S[r][c] *= reciprocal;
        store(S[r][c], rows[r] + half + batch_lanes * (j + c));
      }
    }
  }
}

// 1 / sqrt(pivot) where it is above its threshold; elsewhere 0, and a mark in `failed`.
template <class W>
CSRBF_ALWAYS_INLINE void invert_pivots(const Lanes<W>& pivot, const Lanes<W>& threshold, Lanes<W>& reciprocal,
                                       Lanes<W>& failed) {
  const Lanes<W> none = {};
  const Lanes<W> one = none + 1;
  Lanes<W> root;
  for (int s = 0; s < W::width; ++s) root[s] = std::sqrt(pivot[s]);
  reciprocal = pivot > threshold ? one / root : none;
  failed = pivot > threshold ? failed : one;
}

// The Cholesky factor of the diagonal block of R rows starting at row i, the rows to the left of it being done.
template <class W, int R>
CSRBF_ALWAYS_INLINE void factorise_diagonal(double* const (&rows)[R], Index i, double tolerance, double* failed) {
  for (int half = 0; half < batch_lanes; half += W::width) {
    Tile<W, R, R> S = {};
    Lanes<W> threshold[R];
    Lanes<W> marks;
    const double* from[R];
    load(marks, failed + half);
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) {
      from[r] = rows[r] + half;
#pragma GCC unroll 4
      for (int c = 0; c <= r; ++c) load(S[r][c], from[r] + batch_lanes * (i + c));
      threshold[r] = tolerance * S[r][r];
    }
    subtract_products<W, R, R>(from, from, i, S);
#pragma GCC unroll 4
    for (int c = 0; c < R; ++c) {
      Lanes<W> reciprocal;
      invert_pivots<W>(S[c][c], threshold[c], reciprocal, marks);
      store(reciprocal, rows[c] + half + batch_lanes * (i + c));
#pragma GCC unroll 4
      for (int r = c + 1; r < R; ++r) {
        S[r][c] *= reciprocal;
        store(S[r][c], rows[r] + half + batch_lanes * (i + c));
#pragma GCC unroll 4
        for (int b = c + 1; b <= r; ++b) S[r][b] -= S[r][c] * S[b][c];
      }
    }
    store(marks, failed + half);
  }
}

// Rows i, ..., i + R - 1 of the factor, from those above.
template <class W, int R>
CSRBF_ALWAYS_INLINE void factorise_rows(double* A, Index i, double tolerance, double* failed) {
  double* rows[R];
  for (int r = 0; r < R; ++r) rows[r] = A + batch_entry(i + r, 0);
  for (Index j = 0; j < i; j += W::tile) {
    const double* cols[W::tile];
    for (int c = 0; c < W::tile; ++c) cols[c] = A + batch_entry(j + c, 0);
    eliminate<W, R, W::tile>(rows, cols, j);
  }
  factorise_diagonal<W, R>(rows, i, tolerance, failed);
}

template <class W>
CSRBF_ALWAYS_INLINE void factorise_all(double* A, Index n, double tolerance, double* failed) {
  Index i = 0;
  for (; i + W::tile <= n; i += W::tile) factorise_rows<W, W::tile>(A, i, tolerance, failed);
  if (n - i == 3) factorise_rows<W, 3>(A, i, tolerance, failed);
  if (n - i == 2) factorise_rows<W, 2>(A, i, tolerance, failed);
  if (n - i == 1) factorise_rows<W, 1>(A, i, tolerance, failed);
}

// Column block J of L^T x = y, the unknowns after it being done: solves for x_J and takes it out of the rows before.
template <class W, int R, int C>
CSRBF_ALWAYS_INLINE void substitute_back(const double* L, Index j, double* const (&rows)[R]) {
  for (int half = 0; half < batch_lanes; half += W::width) {
    Tile<W, R, C> X;
    const double* cols[C];
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) cols[c] = L + batch_entry(j + c, 0) + half;
#pragma GCC unroll 4
    for (int c = C - 1; c >= 0; --c) {
      Lanes<W> reciprocal;
      load(reciprocal, cols[c] + batch_lanes * (j + c));
#pragma GCC unroll 4
      for (int r = 0; r < R; ++r) {
        load(X[r][c], rows[r] + half + batch_lanes * (j + c));
#pragma GCC unroll 4
        for (int b = C - 1; b > c; --b) {
          Lanes<W> l;
          load(l, cols[b] + batch_lanes * (j + c));
          X[r][c] -= X[r][b] * l;
        }
        X[r][c] *= reciprocal;
        store(X[r][c], rows[r] + half + batch_lanes * (j + c));
      }
    }
    for (Index i = 0; i < batch_lanes * j; i += batch_lanes) {
      Lanes<W> l[C];
#pragma GCC unroll 4
      for (int c = 0; c < C; ++c) load(l[c], cols[c] + i);
#pragma GCC unroll 4
      for (int r = 0; r < R; ++r) {
        Lanes<W> y;
        load(y, rows[r] + half + i);
#pragma GCC unroll 4
        for (int c = 0; c < C; ++c) y -= l[c] * X[r][c];
        store(y, rows[r] + half + i);
      }
    }
  }
}

template <class W, int R, int C>
CSRBF_ALWAYS_INLINE void substitute(const double* L, Index j, double* const (&rows)[R]) {
  const double* cols[C];
  for (int c = 0; c < C; ++c) cols[c] = L + batch_entry(j + c, 0);
  eliminate<W, R, C>(rows, cols, j);
}

// R right-hand sides, forwards and backwards.
template <class W, int R>
CSRBF_ALWAYS_INLINE void solve_rows(const double* L, Index n, double* b) {
  double* rows[R];
  for (int r = 0; r < R; ++r) rows[r] = b + batch_lanes * n * r;
  const Index full = n - n % W::tile;
  for (Index j = 0; j < full; j += W::tile) substitute<W, R, W::tile>(L, j, rows);
  if (n - full == 3) substitute<W, R, 3>(L, full, rows), substitute_back<W, R, 3>(L, full, rows);
  if (n - full == 2) substitute<W, R, 2>(L, full, rows), substitute_back<W, R, 2>(L, full, rows);
  if (n - full == 1) substitute<W, R, 1>(L, full, rows), substitute_back<W, R, 1>(L, full, rows);
  for (Index j = full - W::tile; j >= 0; j -= W::tile) substitute_back<W, R, W::tile>(L, j, rows);
}

template <class W>
CSRBF_ALWAYS_INLINE void solve_all(const double* L, Index n, double* b, Index count) {
  Index r = 0;
  for (; r + W::tile <= count; r += W::tile) solve_rows<W, W::tile>(L, n, b + batch_lanes * n * r);
  if (count - r == 3) solve_rows<W, 3>(L, n, b + batch_lanes * n * r);
  if (count - r == 2) solve_rows<W, 2>(L, n, b + batch_lanes * n * r);
  if (count - r == 1) solve_rows<W, 1>(L, n, b + batch_lanes * n * r);
}

// Entries (i + r, j + c) of A += F^T F; only c <= r are stored when the block is on the diagonal.
template <class W, int R, int C>
CSRBF_ALWAYS_INLINE void gram_tile(const double* F, Index rows, Index n, Index i, Index j, double* A) {
  for (int half = 0; half < batch_lanes; half += W::width) {
    Tile<W, R, C> S = {};
    for (Index k = 0; k < rows; ++k) {
      const double* row = F + batch_lanes * n * k + half;
      Lanes<W> a[R];
      Lanes<W> b[C];
#pragma GCC unroll 4
      for (int r = 0; r < R; ++r) load(a[r], row + batch_lanes * (i + r));
#pragma GCC unroll 4
      for (int c = 0; c < C; ++c) load(b[c], row + batch_lanes * (j + c));
#pragma GCC unroll 4
      for (int r = 0; r < R; ++r) {
#pragma GCC unroll 4
        for (int c = 0; c < C; ++c) S[r][c] += a[r] * b[c];
      }
    }
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) {
#pragma GCC unroll 4
      for (int c = 0; c < C; ++c) {
        if (i == j && c > r) continue;
        double* to = A + batch_entry(i + r, j + c) + half;
        Lanes<W> sum;
        load(sum, to);
        sum += S[r][c];
        store(sum, to);
      }
    }
  }
}

template <class W, int R>
CSRBF_ALWAYS_INLINE void gram_rows(const double* F, Index rows, Index n, Index i, double* A) {
  for (Index j = 0; j < i; j += W::tile) gram_tile<W, R, W::tile>(F, rows, n, i, j, A);
  gram_tile<W, R, R>(F, rows, n, i, i, A);
}

template <class W>
CSRBF_ALWAYS_INLINE void gram_all(const double* F, Index rows, Index n, double* A) {
  Index i = 0;
  for (; i + W::tile <= n; i += W::tile) gram_rows<W, W::tile>(F, rows, n, i, A);
  if (n - i == 3) gram_rows<W, 3>(F, rows, n, i, A);
  if (n - i == 2) gram_rows<W, 2>(F, rows, n, i, A);
  if (n - i == 1) gram_rows<W, 1>(F, rows, n, i, A);
}

CSRBF_SIMD_CLONES void gram_by_four(const double* F, Index rows, Index n, double* A) {
  gram_all<Narrow>(F, rows, n, A);
}
CSRBF_SIMD_WIDE void gram_by_eight(const double* F, Index rows, Index n, double* A) {
  gram_all<Wide>(F, rows, n, A);
}
CSRBF_SIMD_CLONES void factorise_by_four(double* A, Index n, double tolerance, double* failed) {
  factorise_all<Narrow>(A, n, tolerance, failed);
}
CSRBF_SIMD_WIDE void factorise_by_eight(double* A, Index n, double tolerance, double* failed) {
  factorise_all<Wide>(A, n, tolerance, failed);
}
CSRBF_SIMD_CLONES void solve_by_four(const double* L, Index n, double* b, Index count) {
  solve_all<Narrow>(L, n, b, count);
}
CSRBF_SIMD_WIDE void solve_by_eight(const double* L, Index n, double* b, Index count) {
  solve_all<Wide>(L, n, b, count);
}

bool by_eight(BatchWidth width) {
  return width == BatchWidth::widest && has_wide_simd();
}

}  // namespace

void batch_gram(const double* F, Index rows, Index n, double* A, BatchWidth width) {
  // As many rows at a time as stay in the cache while all pairs of their entries are visited: 64 KB (chosen by hand),
  // and no more than fit a first-level cache of 64 sets and eight ways when the length of a row shares powers of two
  // with the number of sets.
  constexpr Index cached = 65536 / (batch_lanes * sizeof(double));
  constexpr Index sets = 64;
  constexpr Index ways = 6;         // two are left for A
  constexpr Index fewest_rows = 4;  // fewer would load and store A too often
  const Index chunk = std::max(fewest_rows, std::min(cached / std::max<Index>(n, 1), ways * sets / std::gcd(n, sets)));
  const auto gram = by_eight(width) ? gram_by_eight : gram_by_four;
  for (Index k = 0; k < rows; k += chunk) gram(F + batch_lanes * n * k, std::min(chunk, rows - k), n, A);
}

BatchMask batch_cholesky(double* A, Index n, double tolerance, BatchWidth width) {
  // Unknowns. In smaller systems every division waits for the one before, and those of two halves of the lanes overlap.
  // How the value was found is not recorded.
  constexpr Index fewest_by_eight = 24;
  double failed[batch_lanes] = {};
  (by_eight(width) && n >= fewest_by_eight ? factorise_by_eight : factorise_by_four)(A, n, tolerance, failed);
  BatchMask mask = 0;
  for (int s = 0; s < batch_lanes; ++s) mask |= static_cast<BatchMask>(failed[s] != 0) << s;
  return mask;
}

void batch_solve(const double* L, Index n, double* b, Index count, BatchWidth width) {
  // Unknowns. With few right-hand sides and a larger factor, which exceeds the first-level cache, memory is the limit:
  // eight lanes at a time are used only where they are faster.
  constexpr Index most_in_cache = 48;
  const bool wide = by_eight(width) && (count >= Wide::tile || n <= most_in_cache);
  (wide ? solve_by_eight : solve_by_four)(L, n, b, count);
}

void batch_pad(double* A, Index n, int lane, Index size) {
  for (Index i = size; i < n; ++i)
    for (Index j = 0; j <= i; ++j) A[batch_entry(i, j) + lane] = i == j ? 1 : 0;
}

}  // namespace csrbf
