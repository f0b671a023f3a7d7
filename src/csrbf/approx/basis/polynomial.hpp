#pragma once

#include "csrbf/core/types.hpp"

#include <array>
#include <vector>

namespace csrbf {

/// The number of monomials of degree at most m: (degree + dimension choose dimension); 0 for negative degrees.
Index monomial_count(int dimension, int degree);

/// The monomials of degree at most m in Dim variables, by degree, within one degree in lexicographic order: in the
/// plane 1, x, y, xx, xy, yy, xxx, ... A basis of the polynomials Pi_m. Well conditioned only for points of about
/// [-1, 1]^Dim: shift and scale first.
template <int Dim>
class Polynomials {
 public:
  /// `degree` -1: no polynomial. Throws InvalidInput unless -1 <= degree <= 20.
  explicit Polynomials(int degree);

  [[nodiscard]] int degree() const { return degree_; }

  /// Q, the number of monomials.
  [[nodiscard]] Index size() const { return static_cast<Index>(exponents_.size()); }

  /// dim Pi_degree, see monomial_count().
  [[nodiscard]] static Index size(int degree) { return monomial_count(Dim, degree); }

  /// The largest degree whose size is at most `count`; -1 for none.
  [[nodiscard]] static int largest_degree(Index count);

  /// The power of each variable in monomial j.
  [[nodiscard]] const std::array<int, Dim>& exponents(Index j) const { return exponents_[j]; }

  /// All monomials at n points, and their derivatives unless the pointers are null (a Hessian needs the gradient). O(n
  /// Q), Dim and Dim^2 times that.
  ///
  /// * value: n x Q, column major.
  /// * gradient: (Dim n) x Q, column major: column j is the Dim x n array of gradients of monomial j.
  /// * hessian: (symmetric_size<Dim> n) x Q, likewise, upper triangles by rows as in Jet.
  ///
  /// So the product of each matrix with the coefficients is the array of that name in a Jet.
  void rows(const PointsRef<Dim>& x, double* value, double* gradient = nullptr, double* hessian = nullptr) const;

  /// How a monomial follows from an earlier one: it is x[axis] times monomial `parent`.
  struct Step {
    Index parent;
    int axis;
  };
  /// Of every monomial; meaningless for the constant.
  [[nodiscard]] const std::vector<Step>& steps() const { return steps_; }

 private:
  int degree_;
  std::vector<std::array<int, Dim>> exponents_;
  std::vector<Step> steps_;
};

/// The monomials in the order in which Horner's scheme uses their coefficients: by the power of the last variable, the
/// highest first, then by that of the one before it, and so on.
template <int Dim>
std::vector<Index> nested_order(const Polynomials<Dim>& basis);

}  // namespace csrbf
