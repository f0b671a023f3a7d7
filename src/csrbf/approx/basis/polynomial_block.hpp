#pragma once

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/basis/polynomial.hpp"

namespace csrbf {

/// What to do when the points lie on the zero set of a polynomial of the degree (collinear points, too few points).
enum class RankDeficiency {
  keep,   ///< keep all monomials; solve_saddle() refuses the system
  reduce  ///< restrict to the polynomials that the points distinguish; those that vanish there are left out
};

/// The polynomial part of an interpolation system: r functions that span the polynomials of the degree on the points.
template <int Dim>
struct PolynomialBlock {
  Eigen::MatrixXd G;          ///< n x r: the functions at the points; r = 0 for degree -1
  Eigen::MatrixXd monomials;  ///< Q x r: their coefficients in Polynomials<Dim>(degree)
  PolynomialTail<Dim> frame;  ///< degree, origin and scale; no coefficients

  /// The tail with coefficients pi (r) of the functions.
  [[nodiscard]] PolynomialTail<Dim> tail(const Eigen::Ref<const Eigen::VectorXd>& pi) const {
    PolynomialTail<Dim> result = frame;
    result.coefficients = monomials * pi;
    return result;
  }
};

/// Monomials about the centre of the bounding box, in units of half its largest extent and scaled to unit norm on the
/// points, so that axes of different units are harmless. O(n Q^2).
template <int Dim>
PolynomialBlock<Dim> polynomial_block(const PointsRef<Dim>& points, int degree, RankDeficiency deficiency);

}  // namespace csrbf
