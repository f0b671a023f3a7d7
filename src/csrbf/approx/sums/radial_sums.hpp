#pragma once

#include "csrbf/core/types.hpp"

#include <array>

namespace csrbf {

/// Centres of radial functions as arrays: row k of `position` holds coordinate k of all centres, `stride` apart. Slots
/// come in blocks of 8.
struct CenterArrays {
  int dimension = 0;
  Index stride = 0;
  const double* position = nullptr;  ///< dimension rows
  const double* shape = nullptr;     ///< S with r^2 = x^T S x: 1/sigma^2, or the upper triangles of S, one entry a row
  bool anisotropic = false;          ///< whether `shape` holds triangles
};

/// Part of one sum over centres, small enough for the first-level cache.
struct RadialBatch {
  static constexpr Index capacity = 256;  ///< slots, chosen by hand: 12 arrays take 24 KB, in six dimensions
  static constexpr int max_dimension = most_variables;

  Index size = 0;
  int runs = 0;
  std::array<Index, capacity / 8> slot{};    ///< first slot of each run
  std::array<Index, capacity / 8> length{};  ///< multiples of 8
  alignas(64) double r2[capacity];           ///< squared distances in units of the support
  alignas(64) double phi[capacity];
  alignas(64) double g[capacity];
  alignas(64) double h[capacity];
  alignas(64) double v[max_dimension][capacity];  ///< S (p - c)
};

/// Fills r2, and v when `with_directions`, for the point p.
void radial_distances(const CenterArrays& centers, const double* p, bool with_directions, RadialBatch& batch);

/// Sums over the batch times `coefficients` (one per slot), added to value (1), gradient (dimension), hessian (upper
/// triangle); null pointers are skipped.
void add_radial_sums(const CenterArrays& centers, const double* coefficients, const RadialBatch& batch, double* value,
                     double* gradient, double* hessian);

}  // namespace csrbf
