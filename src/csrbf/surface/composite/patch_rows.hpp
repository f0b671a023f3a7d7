#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// Fills the 4 K rows of the quadric model at K samples q (K x 3, column-major): K values times root_w, then three
/// times K derivatives times root_g; column-major, 10 columns: 1, x, y, z, x^2, x y, x z, y^2, y z, z^2.
void quadric_columns(const double* q, Index K, const double* root_w, const double* root_g, double* columns);

/// The same for M Wendland C4 functions of support radius Patches::support around `centers` (3 x M): M columns.
void kernel_columns(const double* q, Index K, const double* root_w, const double* root_g, const double* centers,
                    Index M, double* columns);

/// Values and gradients, 4 columns of K, at K points q (K x 3, column-major) of a quadric with those ten coefficients
/// and M such functions with coefficients alpha.
void piece_jets(const double* q, Index K, const double* quadric, const double* centers, const double* alpha, Index M,
                double* jets);

/// Adds `factor` times the kernel matrix of M such functions around `centers` (M x 3, column-major) to the lower
/// triangle of A (column-major, columns `stride` apart); its upper triangle has no meaning afterwards.
void add_kernel_matrix(const double* centers, Index M, double factor, double* A, Index stride);

}  // namespace csrbf
