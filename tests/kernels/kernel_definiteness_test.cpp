#include "kernels/kernel_testing.hpp"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <functional>
#include <random>

namespace csrbf::kernel_definiteness_test {
namespace {

// Distances of random points in the unit cube over a support that holds about 40 of them.
Eigen::MatrixXd random_points(int dimension, int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Eigen::MatrixXd points(dimension, count);
  for (double& x : points.reshaped()) x = uniform(random);
  return points;
}

Eigen::MatrixXd kernel_matrix(const Kernel& kernel, const Eigen::MatrixXd& points) {
  const Index n = points.cols();
  Eigen::MatrixXd r2(n, n);
  for (Index i = 0; i < n; ++i) r2.col(i) = (points.colwise() - points.col(i)).colwise().squaredNorm().transpose();
  double support2 = 1;
  if (kernel.compact()) {
    support2 = 0;
    for (Index i = 0; i < n; ++i) {
      Eigen::VectorXd sorted = r2.col(i);
      std::sort(sorted.begin(), sorted.end());
      support2 += sorted[std::min<Index>(40, n - 1)] / static_cast<double>(n);
    }
  } else if (kernel.has_scale()) {
    support2 = .04;
  }
  r2 /= support2;
  Eigen::MatrixXd A(n, n);
  kernel.values(r2.data(), n * n, A.data());
  return A;
}

// Orthonormal basis of the coefficients orthogonal to the polynomials of degree order - 1.
Eigen::MatrixXd orthogonal_to_polynomials(const Eigen::MatrixXd& points, int order) {
  const Index n = points.cols();
  std::vector<Eigen::VectorXd> columns;
  const std::function<void(Index, int, const Eigen::VectorXd&)> add = [&](Index axis, int left,
                                                                          const Eigen::VectorXd& product) {
    if (axis == points.rows()) {
      columns.push_back(product);
      return;
    }
    Eigen::VectorXd power = product;
    for (int e = 0; e <= left; ++e) {
      add(axis + 1, left - e, power);
      power = power.cwiseProduct((points.row(axis).transpose().array() - .5).matrix());
    }
  };
  if (order == 0) return Eigen::MatrixXd::Identity(n, n);
  add(0, order - 1, Eigen::VectorXd::Ones(n));
  Eigen::MatrixXd G(n, columns.size());
  for (std::size_t j = 0; j < columns.size(); ++j) G.col(static_cast<Index>(j)) = columns[j];
  const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(G).householderQ();
  return Q.rightCols(n - G.cols());
}

TEST(Kernel, IsConditionallyPositiveDefiniteOfItsOrderInItsDimensions) {
  for (int d = 1; d <= 4; ++d) {
    const Eigen::MatrixXd points = random_points(d, 60, 5 + static_cast<unsigned>(d));
    for (const Named& named : all_kernels(d)) {
      const Kernel kernel(named.name, d, named.parameter);
      const Eigen::MatrixXd A = kernel_matrix(kernel, points);
      const Eigen::MatrixXd Z = orthogonal_to_polynomials(points, kernel.order());
      const Eigen::VectorXd eigenvalues =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Z.transpose() * A * Z, Eigen::EigenvaluesOnly).eigenvalues();
      // In one dimension the analytic kernels are singular to working precision.
      const double slack = kernel.smoothness() == 100 ? 1e-13 * eigenvalues.maxCoeff() : 0;
      EXPECT_GT(eigenvalues.minCoeff(), -slack) << label(named) << " in dimension " << d;
    }
  }
}

TEST(Kernel, OfOneOrderLessIsNotPositiveDefinite) {
  const Eigen::MatrixXd points = random_points(2, 60, 9);
  for (const Named& named : all_kernels(2)) {
    const Kernel kernel(named.name, 2, named.parameter);
    if (kernel.order() == 0) continue;
    const Eigen::MatrixXd A = kernel_matrix(kernel, 5 * points);
    const Eigen::MatrixXd Z = orthogonal_to_polynomials(points, kernel.order() - 1);
    const Eigen::VectorXd eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Z.transpose() * A * Z, Eigen::EigenvaluesOnly).eigenvalues();
    EXPECT_LT(eigenvalues.minCoeff(), 0) << label(named);
  }
}

}  // namespace
}  // namespace csrbf::kernel_definiteness_test
