#pragma once

#include "csrbf/approx/basis/radial_basis.hpp"

#include <memory>

namespace csrbf {

struct FarField;

/// Polynomial sum_q c_q m_q((p - origin) / scale) over the monomials m_q of Polynomials<Dim>(degree).
template <int Dim>
struct PolynomialTail {
  int degree = -1;  ///< -1: none
  Point<Dim> origin = Point<Dim>::Zero();
  double scale = 1;
  Eigen::VectorXd coefficients = {};
};

/// f(p) = sum_j alpha_j phi(|p - c_j|_j / sigma_j) + polynomial: what every fit by radial basis functions returns
/// (thesis eqs. 2.5 and 2.10). Several expansions may share one basis.
template <int Dim>
class Expansion : public Field<Dim> {
 public:
  /// `bounds`: where the data are; default: the box of the centres.
  /// Throws InvalidInput when the number of coefficients is not that of the basis or of the polynomial.
  Expansion(std::shared_ptr<const RadialBasis<Dim>> basis, Eigen::VectorXd coefficients, PolynomialTail<Dim> tail = {},
            const Box<Dim>& bounds = {});

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<Dim> bounds() const override { return bounds_; }
  /// The smallest support.
  [[nodiscard]] double feature_size() const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override;

  /// For Wendland functions of smoothness 2 or more, Euclidean distances and a polynomial of degree 2 at most: from the
  /// Taylor expansion about the centre of the box and the largest second derivatives, sum |alpha_j| |phi''(0)| /
  /// sigma_j^2 over the supports that meet the box (thesis eq. 4.8 with the factor 1 / sigma^2).
  [[nodiscard]] std::optional<Enclosure> enclose(const Box<Dim>& box) const override;

  [[nodiscard]] const RadialBasis<Dim>& basis() const { return *basis_; }
  [[nodiscard]] std::shared_ptr<const RadialBasis<Dim>> shared_basis() const { return basis_; }
  [[nodiscard]] const Eigen::VectorXd& coefficients() const { return coefficients_; }
  [[nodiscard]] const PolynomialTail<Dim>& tail() const { return tail_; }

 private:
  struct LazyFarField;

  void add_tail(const PointsRef<Dim>& x, const JetBlock& out) const;
  [[nodiscard]] const FarField& far_field(const FastSum<Dim>& fast) const;
  void add_fast_sums(const FastSum<Dim>& sum, const PointsRef<Dim>& x, const JetBlock& out) const;

  std::shared_ptr<const RadialBasis<Dim>> basis_;
  Eigen::VectorXd coefficients_;
  Eigen::VectorXd slot_coefficients_;
  std::shared_ptr<LazyFarField> far_field_;  // of fast sums
  PolynomialTail<Dim> tail_;
  Box<Dim> bounds_;
};

/// As the constructor, for centres, supports (1 or M) and coefficients (M).
template <int Dim>
std::shared_ptr<const Expansion<Dim>> make_expansion(const Kernel& kernel, const PointsRef<Dim>& centers,
                                                     const Eigen::VectorXd& supports, Eigen::VectorXd coefficients,
                                                     PolynomialTail<Dim> tail = {},
                                                     const RadialMetric<Dim>& metric = {}) {
  return std::make_shared<const Expansion<Dim>>(
      std::make_shared<const RadialBasis<Dim>>(kernel, centers, supports, metric), std::move(coefficients),
      std::move(tail));
}

}  // namespace csrbf
