#include "csrbf/linalg/gram.hpp"

#include "csrbf/core/lanes.hpp"

namespace csrbf {
namespace {

// A tile of 3 x 3 entries fills the 16 registers of AVX2, and each vector loaded is used three times.
constexpr int tile = 3;

template <int Bytes, int R, int C>
CSRBF_ALWAYS_INLINE void products(const double* rows_of, const double* cols_of, Index rows, Index n, double* A) {
  using Sums = Lanes<double, gram_rows, Bytes>;
  Sums S[R][C] = {};
  for (Index k = 0; k < rows; k += Sums::size) {
    Sums a[R];
    Sums b[C];
#pragma GCC unroll 3
    for (int r = 0; r < R; ++r) a[r] = Sums(rows_of + r * rows + k);
#pragma GCC unroll 3
    for (int c = 0; c < C; ++c) b[c] = Sums(cols_of + c * rows + k);
#pragma GCC unroll 3
    for (int r = 0; r < R; ++r) {
#pragma GCC unroll 3
      for (int c = 0; c < C; ++c) S[r][c] += a[r] * b[c];
    }
  }
  for (int r = 0; r < R; ++r)
    for (int c = 0; c < C; ++c) A[c * n + r] = (S[r][c][0] + S[r][c][1]) + (S[r][c][2] + S[r][c][3]);
}

struct GramTiles {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(const double* B, Index rows, Index n, double* A) {
    const Index even = n - n % tile;
    for (Index i = 0; i < even; i += tile) {
      // Entries above the diagonal of a diagonal tile must stay: it is done entry by entry.
      for (Index j = 0; j < i; j += tile)
        products<Bytes, tile, tile>(B + i * rows, B + j * rows, rows, n, A + j * n + i);
      products<Bytes, 3, 1>(B + i * rows, B + i * rows, rows, n, A + i * n + i);
      products<Bytes, 2, 1>(B + (i + 1) * rows, B + (i + 1) * rows, rows, n, A + (i + 1) * n + i + 1);
      products<Bytes, 1, 1>(B + (i + 2) * rows, B + (i + 2) * rows, rows, n, A + (i + 2) * n + i + 2);
    }
    for (Index i = even; i < n; ++i) {
      for (Index j = 0; j < even; j += tile)
        products<Bytes, 1, tile>(B + i * rows, B + j * rows, rows, n, A + j * n + i);
      for (Index j = even; j <= i; ++j) products<Bytes, 1, 1>(B + i * rows, B + j * rows, rows, n, A + j * n + i);
    }
  }
};

struct CrossTiles {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(const double* B, Index n, const double* C, Index m, Index rows, double* A) {
    const Index even_n = n - n % tile, even_m = m - m % tile;
    for (Index j = 0; j < even_m; j += tile) {
      for (Index i = 0; i < even_n; i += tile)
        products<Bytes, tile, tile>(B + i * rows, C + j * rows, rows, n, A + j * n + i);
      for (Index i = even_n; i < n; ++i) products<Bytes, 1, tile>(B + i * rows, C + j * rows, rows, n, A + j * n + i);
    }
    for (Index j = even_m; j < m; ++j) {
      for (Index i = 0; i < even_n; i += tile)
        products<Bytes, tile, 1>(B + i * rows, C + j * rows, rows, n, A + j * n + i);
      for (Index i = even_n; i < n; ++i) products<Bytes, 1, 1>(B + i * rows, C + j * rows, rows, n, A + j * n + i);
    }
  }
};

}  // namespace

void gram(const double* B, Index rows, Index n, double* A) {
  simd_call<GramTiles, 32>(B, rows, n, A);
}

void gram(const double* B, Index n, const double* C, Index m, Index rows, double* A) {
  simd_call<CrossTiles, 32>(B, n, C, m, rows, A);
}

}  // namespace csrbf
