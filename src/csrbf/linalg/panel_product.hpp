#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// The number of rows of A and C given to panel_product() must be a multiple of this; pad with zeros.
inline constexpr Index panel_rows = 8;

/// n rounded up to a multiple of panel_rows.
constexpr Index padded_rows(Index n) {
  return (n + panel_rows - 1) / panel_rows * panel_rows;
}

/// C += A B for column-major A (rows x inner), B (inner x columns) and C (rows x columns); neighbouring columns of B
/// are `stride` apart, those of the others `rows`. For matrices that fit the second-level cache. Each entry is summed
/// in the order of `inner`, whatever the number of columns. O(rows inner columns).
void panel_product(const double* A, Index rows, Index inner, const double* B, Index stride, Index columns, double* C);

}  // namespace csrbf
