#include "csrbf/linalg/gram.hpp"

#include "csrbf/core/simd.hpp"

#include <cstring>

namespace csrbf {
namespace {

// A tile of 3 x 3 sums and the vectors they need fill the 16 registers of AVX2; each vector loaded is used three times.
constexpr int width = gram_rows;
constexpr int tile = 3;
using Lanes = double __attribute__((vector_size(width * sizeof(double))));

template <int R, int C>
CSRBF_ALWAYS_INLINE void products(const double* rows_of, const double* cols_of, Index rows, Index n, double* A) {
  Lanes S[R][C] = {};
  for (Index k = 0; k < rows; k += width) {
    Lanes a[R];
    Lanes b[C];
#pragma GCC unroll 3
    for (int r = 0; r < R; ++r) std::memcpy(&a[r], rows_of + r * rows + k, sizeof(Lanes));
#pragma GCC unroll 3
    for (int c = 0; c < C; ++c) std::memcpy(&b[c], cols_of + c * rows + k, sizeof(Lanes));
#pragma GCC unroll 3
    for (int r = 0; r < R; ++r) {
#pragma GCC unroll 3
      for (int c = 0; c < C; ++c) S[r][c] += a[r] * b[c];
    }
  }
  for (int r = 0; r < R; ++r)
    for (int c = 0; c < C; ++c) A[c * n + r] = (S[r][c][0] + S[r][c][1]) + (S[r][c][2] + S[r][c][3]);
}

}  // namespace

CSRBF_SIMD_CLONES void gram(const double* B, Index rows, Index n, double* A) {
  const Index full = n - n % tile;
  for (Index i = 0; i < full; i += tile) {
    // Entries above the diagonal must not change, so a tile on the diagonal is computed column by column.
    for (Index j = 0; j < i; j += tile) products<tile, tile>(B + i * rows, B + j * rows, rows, n, A + j * n + i);
    products<3, 1>(B + i * rows, B + i * rows, rows, n, A + i * n + i);
    products<2, 1>(B + (i + 1) * rows, B + (i + 1) * rows, rows, n, A + (i + 1) * n + i + 1);
    products<1, 1>(B + (i + 2) * rows, B + (i + 2) * rows, rows, n, A + (i + 2) * n + i + 2);
  }
  for (Index i = full; i < n; ++i) {
    for (Index j = 0; j < full; j += tile) products<1, tile>(B + i * rows, B + j * rows, rows, n, A + j * n + i);
    for (Index j = full; j <= i; ++j) products<1, 1>(B + i * rows, B + j * rows, rows, n, A + j * n + i);
  }
}

}  // namespace csrbf
