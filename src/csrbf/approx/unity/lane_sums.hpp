#pragma once

#include "csrbf/core/types.hpp"

#include <cstdint>

namespace csrbf {

/// Inner loops over radial functions for eight points at a time, coordinate by coordinate: coordinate a of lane l is at
/// x[8 a + l]. Internal.
namespace lane_sums {

inline constexpr int lanes = 8;

/// r2[8 j + l] = scale |x_l - c_j|^2 for n centres, `dim` coordinates each.
void distances(const double* x, int dim, const double* centers, Index n, double scale, double* r2);

/// The jets of n monomials (value, gradient if terms > 1, Hessian if terms > 1 + dim) at x: monomial j is x[axis[j]]
/// times monomial parent[j] < j, the first one is 1. `jets` is work space for n x terms x 8; f, terms x 8, gets the sum
/// of c_j times them.
void polynomial(const double* x, int dim, const std::int16_t* parent, const std::int16_t* axis, Index n,
                const double* c, int terms, double* jets, double* f);

/// p(x) for polynomials of `dim` <= 6 variables and a degree >= 0 in Horner's form, with the coefficients c in the
/// order of `nested_order`.
void nested_polynomial(const double* x, int dim, int degree, const double* c, double* f);

/// Writes to `found` the i in [begin, end) with |x_i - center| < half along every axis, ascending, and returns how many
/// there are; coordinate a of x_i is at x[stride a + i]. Up to 7 numbers behind `end` are read, and behind the last i
/// found written.
std::size_t inside(const double* x, std::size_t stride, int dim, std::uint32_t begin, std::uint32_t end,
                   const double* center, const double* half, std::uint32_t* found);

/// W[i] += w weight[i] and S[i] += w weight[i] p(q[i]) for n values, a multiple of 8, of the polynomial p with the
/// coefficients c[0 .. degree], that of the constant first; S and W are apart.
void add_row(const double* q, const double* weight, Index n, const double* c, int degree, double w, double* W,
             double* S);

/// f[l] += sum_j alpha_j phi[8 j + l].
void add_values(const double* phi, const double* alpha, Index n, double* f);

/// f[8 (1 + a) + l] += sum_j alpha_j scale g[8 j + l] (x_l - c_j)_a.
void add_gradients(const double* g, const double* alpha, Index n, const double* x, int dim, const double* centers,
                   double scale, double* f);

/// The entries of the upper triangle, from f + 8 (1 + dim) on: sum_j alpha_j scale (g I + scale h d d^T).
void add_hessians(const double* g, const double* h, const double* alpha, Index n, const double* x, int dim,
                  const double* centers, double scale, double* f);

/// The jet (value, gradient if terms > 1, Hessian if terms > 1 + dim) of the product over the axes of (1 - t^2)^4, t =
/// (x - center) / half, 0 outside of [-1, 1]. dim <= 8.
void box_weights(const double* x, int dim, const double* center, const double* half, int terms, double* w);

}  // namespace lane_sums
}  // namespace csrbf
