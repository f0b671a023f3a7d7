#include "csrbf/approx/sums/fast_sum.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::fast_sum_test {
namespace {

enum class Shape { cube, sphere, clusters, tracks, layer };

template <int Dim>
Points<Dim> cloud(Index n, Shape shape, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  Points<Dim> x(Dim, n);
  Point<Dim> center = Point<Dim>::Zero();
  for (Index i = 0; i < n; ++i) {
    for (int d = 0; d < Dim; ++d) x(d, i) = uniform(random);
    if (shape == Shape::sphere) x.col(i).normalize();
    if (shape == Shape::clusters) {
      if (i % 200 == 0) center = x.col(i);
      for (int d = 0; d < Dim; ++d) x(d, i) = center[d] + 1e-3 * normal(random);
    }
    if (shape == Shape::tracks) x(Dim - 1, i) = std::round(5 * x(Dim - 1, i));
    if (shape == Shape::layer) x(Dim - 1, i) *= 1e-3;
  }
  return x;
}

Eigen::VectorXd coefficients(Index n) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  return Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); });
}

// Direct sums and their derivatives, and the size of their largest term.
template <int Dim>
Jet<Dim> direct(const Points<Dim>& centers, const Kernel& kernel, double support, const Eigen::VectorXd& alpha,
                const Points<Dim>& x, double& largest) {
  Jet<Dim> jet(x.cols(), Derivatives::hessian);
  jet.value.setZero();
  jet.gradient.setZero();
  jet.hessian.setZero();
  largest = 0;
  for (Index k = 0; k < x.cols(); ++k)
    for (Index j = 0; j < centers.cols(); ++j) {
      const Point<Dim> v = (x.col(k) - centers.col(j)) / support;
      const double r = v.norm();
      largest = std::max({largest, std::abs(kernel.value(r)), std::abs(kernel.value(0))});
      jet.value[k] += alpha[j] * kernel.value(r);
      jet.gradient.col(k) += alpha[j] * kernel.g(r) * v / support;
      for (int a = 0, e = 0; a < Dim; ++a)
        for (int b = a; b < Dim; ++b, ++e)
          jet.hessian(e, k) +=
              alpha[j] * ((a == b ? kernel.g(r) : 0) + kernel.h(r) * v[a] * v[b]) / (support * support);
    }
  return jet;
}

template <int Dim>
void check_products(const Kernel& kernel, double support, Shape shape, double tolerance, Index n = 1000) {
  const Points<Dim> centers = cloud<Dim>(n, shape);
  const Eigen::VectorXd alpha = coefficients(n);
  Eigen::VectorXd expected(n), r2(n), phi(n);
  double largest = std::abs(kernel.value(0));
  for (Index k = 0; k < n; ++k) {
    r2 = (centers.colwise() - centers.col(k)).colwise().squaredNorm().transpose() / (support * support);
    kernel.values(r2.data(), n, phi.data());
    expected[k] = phi.dot(alpha);
    largest = std::max(largest, phi.cwiseAbs().maxCoeff());
  }
  // Small leaves, so that much is far.
  const FastSum<Dim> sum(centers, kernel, support, {.tolerance = tolerance, .leaf_size = 8});
  const double error = (sum.multiply(alpha) - expected).cwiseAbs().maxCoeff();
  EXPECT_LT(error, 8 * tolerance * largest * alpha.norm()) << kernel.name() << " in " << Dim << "D, " << support;
}

template <int Dim>
void check_every_kernel() {
  for (const std::string& name : Kernel::names(Dim)) {
    const Kernel kernel(name, Dim);
    for (const double support : {.3, 2.}) check_products<Dim>(kernel, support, Shape::cube, Dim == 3 ? 1e-4 : 1e-6);
  }
}

TEST(FastSum, OfEveryKernelIsTheDirectSumOnTheLine) {
  check_every_kernel<1>();
}
TEST(FastSum, OfEveryKernelIsTheDirectSumInThePlane) {
  check_every_kernel<2>();
}
TEST(FastSum, OfEveryKernelIsTheDirectSumInSpace) {
  check_every_kernel<3>();
}

TEST(FastSum, KeepsItsToleranceWhateverTheShapeOfTheCloud) {
  for (const Shape shape : {Shape::cube, Shape::sphere, Shape::clusters, Shape::tracks, Shape::layer}) {
    check_products<2>(Kernel("thin-plate", 2), 1, shape, 1e-8, 3000);
    check_products<3>(Kernel("linear", 3), 1, shape, 1e-6, 3000);
  }
}

TEST(FastSum, UsesExpansionsForMostPairs) {
  const FastSum<2> sum(cloud<2>(20000, Shape::cube), Kernel("thin-plate", 2), 1);
  double near = 0;
  for (const auto& box : sum.tree().boxes)
    if (box.leaf())
      for (const auto b : box.near) near += static_cast<double>(box.count * sum.tree().boxes[b].count);
  EXPECT_LT(near / 20000, 600);  // of 20000 centres
}

TEST(FastSum, IsEvaluatedWithDerivativesInsideAndFarOutside) {
  const Index n = 3000;
  const Points<3> centers = cloud<3>(n, Shape::sphere);
  const Kernel kernel("cubic", 3);
  const Eigen::VectorXd alpha = coefficients(n);
  const FastSum<3> sum(centers, kernel, 1, {.tolerance = 1e-8, .leaf_size = 20, .everywhere = true});
  const FarField field = sum.expand(alpha);
  for (const double scale : {1., 1.2, 3., 50.}) {
    const Points<3> x = scale * cloud<3>(60, Shape::cube, 3);
    double largest = 0;
    const Jet<3> expected = direct<3>(centers, kernel, 1, alpha, x, largest);
    Jet<3> jet(x.cols(), Derivatives::hessian);
    jet.value.setZero();
    jet.gradient.setZero();
    jet.hessian.setZero();
    sum.add_sums(field, x, {jet.value.data(), jet.gradient.data(), jet.hessian.data()});
    const double error = 1e-8 * largest * alpha.norm();
    EXPECT_LT((jet.value - expected.value).cwiseAbs().maxCoeff(), 6 * error) << scale;
    EXPECT_LT((jet.gradient - expected.gradient).cwiseAbs().maxCoeff(), 100 * error) << scale;
    EXPECT_LT((jet.hessian - expected.hessian).cwiseAbs().maxCoeff(), 3000 * error) << scale;
  }
}

TEST(FastSum, GivesTheSameBitsForAnyNumberOfThreads) {
  const Points<2> centers = cloud<2>(5000, Shape::clusters);
  const Eigen::VectorXd alpha = coefficients(5000);
  const auto product = [&](int threads) {
    set_thread_count(threads);
    const Eigen::VectorXd result = FastSum<2>(centers, Kernel("thin-plate", 2), 1).multiply(alpha);
    set_thread_count(0);
    return result;
  };
  EXPECT_EQ(product(1), product(3));
}

TEST(FastSum, AcceptsFewAndCoincidentCentres) {
  const Kernel kernel("linear", 3);
  EXPECT_EQ(FastSum<3>(Points<3>::Zero(3, 1), kernel, 1).multiply(Eigen::VectorXd::Ones(1))[0], 0);
  const Eigen::VectorXd sums = FastSum<3>(Points<3>::Zero(3, 500), kernel, 1).multiply(Eigen::VectorXd::Ones(500));
  EXPECT_EQ(sums, Eigen::VectorXd::Zero(500));
  EXPECT_EQ(FastSum<3>(Points<3>(3, 0), kernel, 1).multiply(Eigen::VectorXd(0)).size(), 0);
}

TEST(FastSum, RefusesBadInput) {
  const Points<2> centers = cloud<2>(10, Shape::cube);
  const Kernel kernel("linear", 2);
  const auto message = [&](const Points<2>& points, double support, double tolerance) {
    return invalid_input_message([&] { const FastSum<2> sum(points, kernel, support, {.tolerance = tolerance}); });
  };
  EXPECT_NE(message(centers, 0, 1e-7).find("support"), std::string::npos);
  EXPECT_NE(message(centers, 1, 0).find("tolerance"), std::string::npos);
  Points<2> bad = centers;
  bad(0, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(bad, 1, 1e-7).find("centers"), std::string::npos);
  const FastSum<2> sum(centers, kernel, 1);
  EXPECT_THROW(static_cast<void>(sum.multiply(Eigen::VectorXd::Ones(3))), InvalidInput);
}

}  // namespace
}  // namespace csrbf::fast_sum_test
