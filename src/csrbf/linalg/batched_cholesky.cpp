#include "csrbf/linalg/batched_cholesky.hpp"

#include "csrbf/core/lanes.hpp"

#include <numeric>

namespace csrbf {
namespace {

// The lanes taken at a time, as many as are in a register, and the side of the square of entries that is kept in
// registers meanwhile, where each entry loaded is used as often. The 16 registers of AVX2 hold 3 x 3 entries of four
// lanes, the 32 of AVX-512 4 x 4 of all eight.
template <int Bytes>
struct Registers {
  static constexpr int width = Bytes / static_cast<int>(sizeof(double));
  static constexpr int tile = Bytes == 64 ? 4 : 3;
  using Entry = Lanes<double, width, Bytes>;
};

template <class W>
using Entry = typename W::Entry;

template <class W, int R, int C>
using Tile = Entry<W>[R][C];

// S -= sum_{k < depth} rows[r][k] cols[c][k].
template <class W, int R, int C>
CSRBF_ALWAYS_INLINE void subtract_products(const double* const (&rows)[R], const double* const (&cols)[C], Index depth,
                                           Tile<W, R, C>& S) {
  for (Index k = 0; k < batch_lanes * depth; k += batch_lanes) {
    Entry<W> a[R];
    Entry<W> b[C];
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) a[r] = Entry<W>(rows[r] + k);
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) b[c] = Entry<W>(cols[c] + k);
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
  for (int lane = 0; lane < batch_lanes; lane += W::width) {
    Tile<W, R, C> S;
    const double* from[R];
    const double* against[C];
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) from[r] = rows[r] + lane;
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) against[c] = cols[c] + lane;
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) {
#pragma GCC unroll 4
      for (int c = 0; c < C; ++c) S[r][c] = Entry<W>(from[r] + batch_lanes * (j + c));
    }
    subtract_products<W, R, C>(from, against, j, S);
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) {
#pragma GCC unroll 4
      for (int b = 0; b < c; ++b) {
        const Entry<W> l(against[c] + batch_lanes * (j + b));
#pragma GCC unroll 4
        for (int r = 0; r < R; ++r) S[r][c] -= S[r][b] * l;
      }
      const Entry<W> reciprocal(against[c] + batch_lanes * (j + c));
#pragma GCC unroll 4
      for (int r = 0; r < R; ++r) {
        S[r][c] *= reciprocal;
        S[r][c].store(rows[r] + lane + batch_lanes * (j + c));
      }
    }
  }
}

// 1 / sqrt(pivot) where it is above its threshold; elsewhere 0, and a mark in `failed`.
template <class W>
CSRBF_ALWAYS_INLINE void invert_pivots(const Entry<W>& pivot, const Entry<W>& threshold, Entry<W>& reciprocal,
                                       Entry<W>& failed) {
  const Entry<W> none(0.0), one(1.0);
  const auto above = pivot > threshold;
  reciprocal = choose(above, one / sqrt(pivot), none);
  failed = choose(above, failed, one);
}

// The Cholesky factor of the diagonal block of R rows starting at row i, the rows to the left of it being done.
template <class W, int R>
CSRBF_ALWAYS_INLINE void factorise_diagonal(double* const (&rows)[R], Index i, double tolerance, double* failed) {
  for (int lane = 0; lane < batch_lanes; lane += W::width) {
    Tile<W, R, R> S = {};
    Entry<W> threshold[R];
    Entry<W> marks(failed + lane);
    const double* from[R];
#pragma GCC unroll 4
    for (int r = 0; r < R; ++r) {
      from[r] = rows[r] + lane;
#pragma GCC unroll 4
      for (int c = 0; c <= r; ++c) S[r][c] = Entry<W>(from[r] + batch_lanes * (i + c));
      threshold[r] = tolerance * S[r][r];
    }
    subtract_products<W, R, R>(from, from, i, S);
#pragma GCC unroll 4
    for (int c = 0; c < R; ++c) {
      Entry<W> reciprocal;
      invert_pivots<W>(S[c][c], threshold[c], reciprocal, marks);
      reciprocal.store(rows[c] + lane + batch_lanes * (i + c));
#pragma GCC unroll 4
      for (int r = c + 1; r < R; ++r) {
        S[r][c] *= reciprocal;
        S[r][c].store(rows[r] + lane + batch_lanes * (i + c));
#pragma GCC unroll 4
        for (int b = c + 1; b <= r; ++b) S[r][b] -= S[r][c] * S[b][c];
      }
    }
    marks.store(failed + lane);
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

// Column block J of L^T x = y, the unknowns after it being done: solves for x_J and takes it out of the rows before.
template <class W, int R, int C>
CSRBF_ALWAYS_INLINE void substitute_back(const double* L, Index j, double* const (&rows)[R]) {
  for (int lane = 0; lane < batch_lanes; lane += W::width) {
    Tile<W, R, C> X;
    const double* cols[C];
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) cols[c] = L + batch_entry(j + c, 0) + lane;
#pragma GCC unroll 4
    for (int c = C - 1; c >= 0; --c) {
      const Entry<W> reciprocal(cols[c] + batch_lanes * (j + c));
#pragma GCC unroll 4
      for (int r = 0; r < R; ++r) {
        X[r][c] = Entry<W>(rows[r] + lane + batch_lanes * (j + c));
#pragma GCC unroll 4
        for (int b = C - 1; b > c; --b) {
          const Entry<W> l(cols[b] + batch_lanes * (j + c));
          X[r][c] -= X[r][b] * l;
        }
        X[r][c] *= reciprocal;
        X[r][c].store(rows[r] + lane + batch_lanes * (j + c));
      }
    }
    for (Index i = 0; i < batch_lanes * j; i += batch_lanes) {
      Entry<W> l[C];
#pragma GCC unroll 4
      for (int c = 0; c < C; ++c) l[c] = Entry<W>(cols[c] + i);
#pragma GCC unroll 4
      for (int r = 0; r < R; ++r) {
        Entry<W> y(rows[r] + lane + i);
#pragma GCC unroll 4
        for (int c = 0; c < C; ++c) y -= l[c] * X[r][c];
        y.store(rows[r] + lane + i);
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

// Entries (i + r, j + c) of A += F^T F; only c <= r are stored when the block is on the diagonal.
template <class W, int R, int C>
CSRBF_ALWAYS_INLINE void gram_tile(const double* F, Index rows, Index n, Index i, Index j, double* A) {
  for (int lane = 0; lane < batch_lanes; lane += W::width) {
    Tile<W, R, C> S = {};
    for (Index k = 0; k < rows; ++k) {
      const double* row = F + batch_lanes * n * k + lane;
      Entry<W> a[R];
      Entry<W> b[C];
#pragma GCC unroll 4
      for (int r = 0; r < R; ++r) a[r] = Entry<W>(row + batch_lanes * (i + r));
#pragma GCC unroll 4
      for (int c = 0; c < C; ++c) b[c] = Entry<W>(row + batch_lanes * (j + c));
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
        double* to = A + batch_entry(i + r, j + c) + lane;
        (Entry<W>(to) + S[r][c]).store(to);
      }
    }
  }
}

template <class W, int R>
CSRBF_ALWAYS_INLINE void gram_rows(const double* F, Index rows, Index n, Index i, double* A) {
  for (Index j = 0; j < i; j += W::tile) gram_tile<W, R, W::tile>(F, rows, n, i, j, A);
  gram_tile<W, R, R>(F, rows, n, i, i, A);
}

struct Gram {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(const double* F, Index rows, Index n, double* A) {
    using W = Registers<Bytes>;
    Index i = 0;
    for (; i + W::tile <= n; i += W::tile) gram_rows<W, W::tile>(F, rows, n, i, A);
    if (n - i == 3) gram_rows<W, 3>(F, rows, n, i, A);
    if (n - i == 2) gram_rows<W, 2>(F, rows, n, i, A);
    if (n - i == 1) gram_rows<W, 1>(F, rows, n, i, A);
  }
};
struct Factorise {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(double* A, Index n, double tolerance, double* failed) {
    using W = Registers<Bytes>;
    Index i = 0;
    for (; i + W::tile <= n; i += W::tile) factorise_rows<W, W::tile>(A, i, tolerance, failed);
    if (n - i == 3) factorise_rows<W, 3>(A, i, tolerance, failed);
    if (n - i == 2) factorise_rows<W, 2>(A, i, tolerance, failed);
    if (n - i == 1) factorise_rows<W, 1>(A, i, tolerance, failed);
  }
};
struct Solve {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(const double* L, Index n, double* b, Index count) {
    using W = Registers<Bytes>;
    Index r = 0;
    for (; r + W::tile <= count; r += W::tile) solve_rows<W, W::tile>(L, n, b + batch_lanes * n * r);
    if (count - r == 3) solve_rows<W, 3>(L, n, b + batch_lanes * n * r);
    if (count - r == 2) solve_rows<W, 2>(L, n, b + batch_lanes * n * r);
    if (count - r == 1) solve_rows<W, 1>(L, n, b + batch_lanes * n * r);
  }
};

}  // namespace

void batch_gram(const double* F, Index rows, Index n, double* A) {
  // As many rows at a time as stay in the cache while all pairs of their entries are visited: 64 KB (chosen by hand),
  // and no more than fit a first-level cache of 64 sets and eight ways when the length of a row shares powers of two
  // with the number of sets.
  constexpr Index cached = 65536 / (batch_lanes * sizeof(double));
  constexpr Index sets = 64;
  constexpr Index ways = 6;         // two are left for A
  constexpr Index fewest_rows = 4;  // fewer would load and store A too often
  const Index chunk = std::max(fewest_rows, std::min(cached / std::max<Index>(n, 1), ways * sets / std::gcd(n, sets)));
  for (Index k = 0; k < rows; k += chunk) simd_call<Gram>(F + batch_lanes * n * k, std::min(chunk, rows - k), n, A);
}

BatchMask batch_cholesky(double* A, Index n, double tolerance) {
  // Unknowns. In smaller systems every division waits for the one before, and those of two halves of the lanes overlap.
  // How the value was found is not recorded.
  constexpr Index fewest_by_eight = 24;
  double failed[batch_lanes] = {};
  n >= fewest_by_eight ? simd_call<Factorise>(A, n, tolerance, failed)
                       : simd_call<Factorise, 32>(A, n, tolerance, failed);
  BatchMask mask = 0;
  for (int s = 0; s < batch_lanes; ++s) mask |= static_cast<BatchMask>(failed[s] != 0) << s;
  return mask;
}

void batch_solve(const double* L, Index n, double* b, Index count) {
  // Unknowns. With few right-hand sides and a larger factor, which exceeds the first-level cache, memory is the limit:
  // eight lanes at a time are used only where they are faster.
  constexpr Index most_in_cache = 48;
  const bool wide = count >= Registers<64>::tile || n <= most_in_cache;
  wide ? simd_call<Solve>(L, n, b, count) : simd_call<Solve, 32>(L, n, b, count);
}

}  // namespace csrbf
