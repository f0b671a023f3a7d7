#include "csrbf/linalg/panel_product.hpp"

#include "csrbf/core/lanes.hpp"

namespace csrbf {
namespace {

// Columns at a time, as many as leave registers for a column of A: the tile has panel_rows x 6 sums.
constexpr int tile_columns = 6;

template <int Bytes, int Columns>
CSRBF_ALWAYS_INLINE void multiply_tile(const double* A, Index rows, Index inner, const double* B, Index stride,
                                       double* C) {
  using V = Lanes<double, panel_rows, Bytes>;
  V sum[Columns];
#pragma GCC unroll 6
  for (int c = 0; c < Columns; ++c) sum[c] = V(C + c * rows);
  for (Index k = 0; k < inner; ++k) {
    const V a(A + k * rows);
#pragma GCC unroll 6
    for (int c = 0; c < Columns; ++c) sum[c] += a * B[k + c * stride];
  }
#pragma GCC unroll 6
  for (int c = 0; c < Columns; ++c) sum[c].store(C + c * rows);
}

struct Product {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(const double* A, Index rows, Index inner, const double* B, Index stride,
                                      Index columns, double* C) {
    Index column = 0;
    for (; column + tile_columns <= columns; column += tile_columns)
      for (Index row = 0; row < rows; row += panel_rows)
        multiply_tile<Bytes, tile_columns>(A + row, rows, inner, B + column * stride, stride, C + column * rows + row);
    for (; column < columns; ++column)
      for (Index row = 0; row < rows; row += panel_rows)
        multiply_tile<Bytes, 1>(A + row, rows, inner, B + column * stride, stride, C + column * rows + row);
  }
};

}  // namespace

void panel_product(const double* A, Index rows, Index inner, const double* B, Index stride, Index columns, double* C) {
  simd_call<Product>(A, rows, inner, B, stride, columns, C);
}

}  // namespace csrbf
