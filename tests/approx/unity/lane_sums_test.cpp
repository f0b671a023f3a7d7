#include "csrbf/approx/unity/lane_sums.hpp"

#include "csrbf/approx/basis/polynomial.hpp"

#include "approx/approx_testing.hpp"

#include <cmath>
#include <vector>

namespace csrbf::lane_sums_test {
namespace {

constexpr int L = lane_sums::lanes;
constexpr double rounding = 1e-12;  // sums of fewer than 100 terms of size 1

std::vector<double> random_numbers(Index count, unsigned seed) {
  const Points<1> numbers = (2 * random_points<1>(count, seed).array() - 1).matrix();
  return {numbers.data(), numbers.data() + count};
}

// Point of a lane.
template <int Dim>
Point<Dim> lane(const std::vector<double>& x, int l) {
  Point<Dim> p;
  for (int a = 0; a < Dim; ++a) p[a] = x[L * a + l];
  return p;
}

template <int Dim>
void expect_polynomials(int degree) {
  constexpr int all = 1 + Dim + symmetric_size<Dim>;
  const Polynomials<Dim> basis(degree);
  const Index Q = basis.size();
  std::vector<std::int16_t> parent, axis;
  for (const auto& step : basis.steps()) {
    parent.push_back(static_cast<std::int16_t>(step.parent));
    axis.push_back(static_cast<std::int16_t>(step.axis));
  }
  const std::vector<double> x = random_numbers(L * Dim, 1), c = random_numbers(Q, 2);
  const Eigen::Map<const Eigen::VectorXd> coefficients(c.data(), Q);
  std::vector<double> jets(L * all * Q);
  for (const int terms : {1, 1 + Dim, all}) {
    std::vector<double> f(L * all, 77.0);
    lane_sums::polynomial(x.data(), Dim, parent.data(), axis.data(), Q, c.data(), terms, jets.data(), f.data());
    for (int l = 0; l < L; ++l) {
      const Point<Dim> p = lane<Dim>(x, l);
      Eigen::MatrixXd value(1, Q), gradient(Dim, Q), hessian(symmetric_size<Dim>, Q);
      basis.rows(p, value.data(), gradient.data(), hessian.data());
      Eigen::VectorXd expected(all);
      expected << value * coefficients, gradient * coefficients, hessian * coefficients;
      for (int t = 0; t < all; ++t)
        EXPECT_NEAR(f[L * t + l], t < terms ? expected[t] : 77, 100 * rounding) << Dim << " " << degree << " " << t;
    }
  }
}

TEST(LaneSums, SumPolynomialsAndTheirDerivatives) {
  for (int degree = 0; degree <= 6; ++degree) {
    expect_polynomials<1>(degree);
    expect_polynomials<2>(degree);
    expect_polynomials<3>(degree);
  }
  expect_polynomials<4>(3);
  expect_polynomials<5>(3);
  expect_polynomials<6>(2);
}

TEST(LaneSums, AreZeroForNoMonomials) {
  std::vector<double> f(3 * L, 5.0);
  lane_sums::polynomial(f.data(), 1, nullptr, nullptr, 0, nullptr, 3, nullptr, f.data());
  EXPECT_EQ(f, std::vector<double>(static_cast<std::size_t>(3 * L), 0.0));
}

template <int Dim>
void expect_nested_polynomials(int degree) {
  const Polynomials<Dim> basis(degree);
  const Index Q = basis.size();
  const std::vector<double> x = random_numbers(L * Dim, 1), c = random_numbers(Q, 2);
  std::vector<double> nested, f(L);
  for (const Index j : nested_order(basis)) nested.push_back(c[j]);
  lane_sums::nested_polynomial(x.data(), Dim, degree, nested.data(), f.data());
  for (int l = 0; l < L; ++l) {
    Eigen::RowVectorXd monomials(Q);
    basis.rows(lane<Dim>(x, l), monomials.data());
    EXPECT_NEAR(f[l], monomials * Eigen::Map<const Eigen::VectorXd>(c.data(), Q), 100 * rounding)
        << Dim << " " << degree;
  }
}

TEST(LaneSums, EvaluateNestedPolynomials) {
  for (int degree = 0; degree <= 8; ++degree) {
    expect_nested_polynomials<1>(degree);
    expect_nested_polynomials<2>(degree);
    expect_nested_polynomials<3>(degree);
  }
  expect_nested_polynomials<4>(3);
  expect_nested_polynomials<5>(3);
  expect_nested_polynomials<6>(3);
}

// Ranges of every length up to a few lanes, in and out of step with them.
template <int Dim>
void expect_points_inside() {
  constexpr std::uint32_t n = 3 * L;
  const std::vector<double> x = random_numbers((n + L) * Dim, 1);
  const Point<Dim> center = Point<Dim>::Constant(.1), half = Point<Dim>::Constant(.8);
  for (const std::uint32_t begin : {0U, 3U})
    for (std::uint32_t end = begin; end <= n; ++end) {
      std::vector<std::uint32_t> found(n + L), expected;
      found.resize(lane_sums::inside(x.data(), n + L, Dim, begin, end, center.data(), half.data(), found.data()));
      for (std::uint32_t i = begin; i < end; ++i) {
        Point<Dim> p;
        for (std::uint32_t a = 0; a < Dim; ++a) p[a] = x[(n + L) * a + i];
        if (((p - center).cwiseAbs().array() < half.array()).all()) expected.push_back(i);
      }
      EXPECT_EQ(found, expected) << Dim << " " << begin << " " << end;
    }
}

TEST(LaneSums, FindThePointsInsideABox) {
  expect_points_inside<1>();
  expect_points_inside<2>();
  expect_points_inside<3>();
  expect_points_inside<4>();
  expect_points_inside<5>();
  expect_points_inside<6>();
}

// The jet of the product over the axes of (1 - t^2)^4, from the derivatives of its factors.
template <int Dim>
void expect_box_weights() {
  constexpr int all = 1 + Dim + symmetric_size<Dim>;
  const std::vector<double> x = random_numbers(L * Dim, 1);
  const Point<Dim> center = Point<Dim>::Constant(.1), half = Point<Dim>::LinSpaced(.8, 1.1);
  for (const int terms : {1, 1 + Dim, all}) {
    std::vector<double> w(L * all, 77.0);
    lane_sums::box_weights(x.data(), Dim, center.data(), half.data(), terms, w.data());
    for (int l = 0; l < L; ++l) {
      const Point<Dim> t = (lane<Dim>(x, l) - center).cwiseQuotient(half);
      const auto factor = [&](int a, int order) {
        const double s = 1 - t[a] * t[a];
        if (s <= 0) return 0.0;
        if (order == 0) return std::pow(s, 4);
        if (order == 1) return -8 * t[a] * std::pow(s, 3) / half[a];
        return 8 * s * s * (7 * t[a] * t[a] - 1) / (half[a] * half[a]);
      };
      const auto derivative = [&](int first, int second) {
        double product = 1;
        for (int a = 0; a < Dim; ++a) product *= factor(a, (a == first ? 1 : 0) + (a == second ? 1 : 0));
        return product;
      };
      std::vector<double> expected = {derivative(-1, -1)};
      for (int a = 0; a < Dim; ++a) expected.push_back(derivative(a, -1));
      for (int a = 0; a < Dim; ++a)
        for (int b = a; b < Dim; ++b) expected.push_back(derivative(a, b));
      for (int k = 0; k < all; ++k)
        EXPECT_NEAR(w[L * k + l], k < terms ? expected[k] : 77, 100 * rounding) << Dim << " " << k;
    }
  }
}

TEST(LaneSums, ComputeTheWeightsOfBoxes) {
  expect_box_weights<1>();
  expect_box_weights<2>();
  expect_box_weights<3>();
  expect_box_weights<4>();
  expect_box_weights<5>();
  expect_box_weights<6>();
}

TEST(LaneSums, StoreWeightsOfZeroWhereNoPointIsInside) {
  const std::vector<double> x(L, 2.0), zero(L, 0.0);
  std::vector<double> w(L, 77.0);
  const double center = 0, half = 2;
  lane_sums::box_weights(x.data(), 1, &center, &half, 1, w.data());
  EXPECT_EQ(w, zero);
}

// Sums of alpha_j phi_j with given numbers for phi, g and h, lane by lane from the formulas.
template <int Dim>
void expect_sums(Index n) {
  constexpr int all = 1 + Dim + symmetric_size<Dim>;
  constexpr double scale = 0.7, before = 3;
  const std::vector<double> x = random_numbers(L * Dim, 1), centers = random_numbers(Dim * n, 2),
                            alpha = random_numbers(n, 3), phi = random_numbers(L * n, 4), g = random_numbers(L * n, 5),
                            h = random_numbers(L * n, 6);
  std::vector<double> f(L * all, before), r2(static_cast<std::size_t>(L * n));
  lane_sums::distances(x.data(), Dim, centers.data(), n, scale, r2.data());
  lane_sums::add_values(phi.data(), alpha.data(), n, f.data());
  lane_sums::add_gradients(g.data(), alpha.data(), n, x.data(), Dim, centers.data(), scale, f.data());
  lane_sums::add_hessians(g.data(), h.data(), alpha.data(), n, x.data(), Dim, centers.data(), scale, f.data());
  for (int l = 0; l < L; ++l) {
    double value = before;
    Point<Dim> gradient = Point<Dim>::Constant(before);
    Eigen::Matrix<double, Dim, Dim> hessian = Eigen::Matrix<double, Dim, Dim>::Constant(before);
    for (Index j = 0; j < n; ++j) {
      const auto at = static_cast<std::size_t>(L * j + l);
      const double a = alpha[j];
      const Point<Dim> d = lane<Dim>(x, l) - Eigen::Map<const Point<Dim>>(centers.data() + Dim * j);
      EXPECT_NEAR(r2[at], scale * d.squaredNorm(), rounding);
      value += a * phi[at];
      gradient += a * scale * g[at] * d;
      hessian += a * scale * (g[at] * Eigen::Matrix<double, Dim, Dim>::Identity() + scale * h[at] * d * d.transpose());
    }
    EXPECT_NEAR(f[l], value, rounding);
    for (int a = 0, t = 1 + Dim; a < Dim; ++a) {
      EXPECT_NEAR(f[L * (1 + a) + l], gradient[a], rounding);
      for (int b = a; b < Dim; ++b, ++t) EXPECT_NEAR(f[L * t + l], hessian(a, b), rounding);
    }
  }
}

TEST(LaneSums, SumRadialFunctionsAndTheirDerivatives) {
  for (const Index n : {0, 1, 7, 50}) {
    expect_sums<1>(n);
    expect_sums<2>(n);
    expect_sums<3>(n);
    expect_sums<4>(n);
    expect_sums<5>(n);
    expect_sums<6>(n);
  }
}

}  // namespace
}  // namespace csrbf::lane_sums_test
