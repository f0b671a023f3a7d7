#include "csrbf/approx/unity/local_models.hpp"

#include "approx/partition_testing.hpp"

#include <array>

namespace csrbf::local_models_test {
namespace {

// Random local functions about the middle of the unit cube.
template <int Dim>
LocalModels<Dim> random_models(const std::string& kernel, int degree, Index centers, double support,
                               bool anisotropic = false) {
  LocalModels<Dim> models;
  models.degree = degree;
  models.kernel = Kernel(kernel, Dim);
  models.support = support;
  models.centers_each = centers;
  models.components = 2;
  models.anisotropic = anisotropic;
  models.resize(3);
  EXPECT_EQ(models.size(), 3);
  EXPECT_EQ(models.polynomial_size(), Polynomials<Dim>::size(degree));
  models.center = random_points<Dim>(3, 1);
  models.radius = (0.5 + random_points<1>(3, 2).transpose().array()).matrix();
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (auto* numbers : {&models.position, &models.alpha, &models.polynomial, &models.metric})
    for (double& number : *numbers) number = uniform(random);
  return models;
}

// The jet of all terms at the points of the eight lanes.
template <int Dim>
std::array<std::array<double, LocalModels<Dim>::lanes>, LocalEvaluator<Dim>::terms> evaluate(
    const LocalModels<Dim>& models, Index i, Index component, const Points<Dim>& x, Derivatives derivatives) {
  constexpr int L = LocalModels<Dim>::lanes, terms = LocalEvaluator<Dim>::terms;
  std::array<double, Dim * L> lanes;
  for (int a = 0; a < Dim; ++a)
    for (int l = 0; l < L; ++l) lanes[L * a + l] = x(a, l);
  double f[terms][L];
  LocalEvaluator<Dim>(models).evaluate(i, component, lanes.data(), derivatives, f);
  std::array<std::array<double, L>, terms> result{};
  const int wanted = derivatives == Derivatives::none ? 1 : derivatives == Derivatives::gradient ? 1 + Dim : terms;
  for (int t = 0; t < wanted; ++t) std::copy_n(f[t], L, result[t].begin());
  return result;
}

template <int Dim>
void expect_formula(const std::string& kernel, int degree, Index centers, double support, bool anisotropic = false) {
  constexpr double rounding = 1e-11;
  const LocalModels<Dim> models = random_models<Dim>(kernel, degree, centers, support, anisotropic);
  const Points<Dim> x = random_points<Dim>(8, 5);
  for (Index i = 0; i < 3; ++i)
    for (Index c = 0; c < 2; ++c)
      for (const Derivatives derivatives : {Derivatives::none, Derivatives::gradient, Derivatives::hessian}) {
        const auto f = evaluate<Dim>(models, i, c, x, derivatives);
        for (int l = 0; l < 8; ++l)
          EXPECT_NEAR(f[0][l], plain_value<Dim>(models, i, c, x.col(l)), rounding) << kernel << " " << Dim;
      }
}

TEST(LocalModels, AreTheSumsTheyStandFor) {
  expect_formula<1>("wendland-c0", 3, 5, 1);
  expect_formula<2>("wendland-c4", 2, 10, 4);
  expect_formula<2>("wendland-c2", -1, 10, .5);
  expect_formula<3>("wendland-c6", 4, 30, 2);
  expect_formula<3>("gaussian", 1, 30, .7);
  expect_formula<4>("matern-c4", 2, 12, 1);
  expect_formula<5>("wendland-c2", 1, 12, 3);
  expect_formula<6>("wendland-c4", 2, 0, 3);
  expect_formula<2>("powered-exponential", 1, 12, 4, true);
  expect_formula<3>("wendland-c4", 2, 12, 3, true);
}

// Central differences with step h: third derivatives up to 1e3 times h^2, and rounding over h.
template <int Dim>
void expect_derivatives(const std::string& kernel, int degree, Index centers, double support,
                        bool anisotropic = false) {
  constexpr double h = 1e-5, tolerance = 1e-6;
  const LocalModels<Dim> models = random_models<Dim>(kernel, degree, centers, support, anisotropic);
  const Points<Dim> x = random_points<Dim>(8, 5);
  const auto f = evaluate<Dim>(models, 1, 1, x, Derivatives::hessian);
  const auto first = evaluate<Dim>(models, 1, 1, x, Derivatives::gradient);
  for (int a = 0; a < Dim; ++a) {
    const Points<Dim> ahead = x.colwise() + h * Point<Dim>::Unit(a), behind = x.colwise() - h * Point<Dim>::Unit(a);
    const auto plus = evaluate<Dim>(models, 1, 1, ahead, Derivatives::gradient);
    const auto minus = evaluate<Dim>(models, 1, 1, behind, Derivatives::gradient);
    for (std::size_t l = 0; l < 8; ++l) {
      const auto row = static_cast<std::size_t>(1 + a);
      EXPECT_NEAR(f[row][l], (plus[0][l] - minus[0][l]) / (2 * h), tolerance) << kernel << " " << Dim;
      EXPECT_NEAR(f[row][l], first[row][l], 1e-10);
      for (int b = 0, t = 1 + Dim; b < Dim; ++b)
        for (int c = b; c < Dim; ++c, ++t) {
          if (b != a && c != a) continue;
          const auto other = static_cast<std::size_t>(1 + (b == a ? c : b));
          EXPECT_NEAR(f[t][l], (plus[other][l] - minus[other][l]) / (2 * h), tolerance) << kernel << " " << Dim;
        }
    }
  }
}

TEST(LocalModels, HaveTrueDerivatives) {
  expect_derivatives<1>("wendland-c6", 4, 5, 2);
  expect_derivatives<2>("wendland-c4", 3, 10, 4);
  expect_derivatives<2>("gaussian", -1, 10, 2);
  expect_derivatives<3>("wendland-c6", 2, 20, 3);
  expect_derivatives<3>("inverse-multiquadric", 2, 20, 3);
  expect_derivatives<4>("matern-c6", 2, 12, 2);
  expect_derivatives<5>("wendland-c6", 2, 12, 3);
  expect_derivatives<6>("wendland-c6", 2, 12, 3);
  expect_derivatives<2>("gaussian", 2, 12, 3, true);
  expect_derivatives<3>("wendland-c6", 2, 12, 4, true);
  expect_derivatives<6>("gaussian", 1, 12, 4, true);
}

TEST(LocalModels, AreZeroWithoutTerms) {
  const LocalModels<3> models = random_models<3>("wendland-c2", -1, 0, 1);
  const auto f = evaluate<3>(models, 0, 0, random_points<3>(8, 5), Derivatives::hessian);
  for (const auto& term : f)
    for (const double value : term) EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace csrbf::local_models_test
