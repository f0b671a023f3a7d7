#include "csrbf/approx/basis/polynomial.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace csrbf::polynomial_test {
namespace {

constexpr double rounding = 1e-13;  // some roundings of products of few factors of order 1

template <int Dim>
Points<Dim> random_points(Index n) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Points<Dim> x(Dim, n);
  for (double& value : x.reshaped()) value = uniform(random);
  return x;
}

double monomial(const double* x, const int* exponents, int dimension) {
  double product = 1;
  for (int a = 0; a < dimension; ++a) product *= std::pow(x[a], exponents[a]);
  return product;
}

TEST(Polynomials, OfThePlaneAreOrderedByDegreeThenLexicographically) {
  const Polynomials<2> basis(3);
  const std::array<int, 2> expected[] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1},
                                         {0, 2}, {3, 0}, {2, 1}, {1, 2}, {0, 3}};
  ASSERT_EQ(basis.size(), 10);
  for (Index j = 0; j < basis.size(); ++j) EXPECT_EQ(basis.exponents(j), expected[j]);
}

template <int Dim>
void check_sizes() {
  for (int degree = -1; degree <= 5; ++degree) {
    const Polynomials<Dim> basis(degree);
    EXPECT_EQ(basis.size(), Polynomials<Dim>::size(degree));
    EXPECT_EQ(Polynomials<Dim>::largest_degree(basis.size()), degree);
    EXPECT_EQ(Polynomials<Dim>::largest_degree(std::max<Index>(basis.size() - 1, 0)), std::max(degree - 1, -1));
  }
}

TEST(Polynomials, HaveTheBinomialSize) {
  EXPECT_EQ(Polynomials<3>::size(3), 20);
  EXPECT_EQ(Polynomials<6>::size(2), 28);
  check_sizes<1>();
  check_sizes<2>();
  check_sizes<3>();
  check_sizes<4>();
  check_sizes<6>();
}

// Derivatives of a monomial: lower an exponent and multiply by it.
template <int Dim>
void check_rows() {
  const Index n = 7;
  const Points<Dim> x = random_points<Dim>(n);
  const Polynomials<Dim> basis(4);
  constexpr int entries = symmetric_size<Dim>;
  Eigen::MatrixXd value(n, basis.size());
  Eigen::MatrixXd gradient(Dim * n, basis.size());
  Eigen::MatrixXd hessian(entries * n, basis.size());
  basis.rows(x, value.data(), gradient.data(), hessian.data());
  for (Index j = 0; j < basis.size(); ++j) {
    for (Index i = 0; i < n; ++i) {
      const double* p = x.col(i).data();
      EXPECT_NEAR(value(i, j), monomial(p, basis.exponents(j).data(), Dim), rounding);
      int entry = 0;
      for (std::size_t a = 0; a < Dim; ++a) {
        auto once = basis.exponents(j);
        const double factor = once[a]--;
        const double slope = factor == 0 ? 0 : factor * monomial(p, once.data(), Dim);
        EXPECT_NEAR(gradient(Dim * i + static_cast<Index>(a), j), slope, rounding);
        for (std::size_t b = a; b < Dim; ++b, ++entry) {
          auto twice = once;
          const double product = factor * twice[b]--;
          const double bend = product == 0 ? 0 : product * monomial(p, twice.data(), Dim);
          EXPECT_NEAR(hessian(entries * i + entry, j), bend, rounding);
        }
      }
    }
  }
}

TEST(Polynomials, AndTheirDerivativesAreProductsOfPowers) {
  check_rows<1>();
  check_rows<2>();
  check_rows<3>();
  check_rows<5>();
  check_rows<6>();
}

TEST(Polynomials, TimesCoefficientsGiveTheArraysOfAJet) {
  const Points<2> x = random_points<2>(5);
  const Polynomials<2> basis(2);
  Eigen::MatrixXd value(5, 6);
  Eigen::MatrixXd gradient(10, 6);
  Eigen::MatrixXd hessian(15, 6);
  basis.rows(x, value.data(), gradient.data(), hessian.data());
  const Eigen::VectorXd c = Eigen::VectorXd::LinSpaced(6, 1, 6);  // 1 + 2x + 3y + 4xx + 5xy + 6yy
  Jet<2> jet(5, Derivatives::hessian);
  jet.value = value * c;
  jet.gradient.reshaped() = gradient * c;
  jet.hessian.reshaped() = hessian * c;
  for (Index i = 0; i < 5; ++i) {
    const double X = x(0, i);
    const double Y = x(1, i);
    EXPECT_NEAR(jet.value[i], 1 + 2 * X + 3 * Y + 4 * X * X + 5 * X * Y + 6 * Y * Y, rounding);
    EXPECT_NEAR((jet.gradient.col(i) - Point<2>(2 + 8 * X + 5 * Y, 3 + 5 * X + 12 * Y)).norm(), 0, rounding);
    EXPECT_NEAR((jet.hessian.col(i) - Eigen::Vector3d(8, 5, 12)).norm(), 0, rounding);
  }
}

TEST(Polynomials, OfDegreeMinusOneAreNone) {
  const Polynomials<3> none(-1);
  EXPECT_EQ(none.size(), 0);
  none.rows(random_points<3>(4), nullptr);
}

TEST(Polynomials, RejectDegreesOutOfRange) {
  try {
    Polynomials<2> basis(-2);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "Polynomials: degree = -2: must be -1 (none), 0, ... or 20");
  }
  EXPECT_THROW(Polynomials<2>(21), InvalidInput);
}

}  // namespace
}  // namespace csrbf::polynomial_test
