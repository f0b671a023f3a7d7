#include "csrbf/linalg/toeplitz_system.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/kernels/kernel.hpp"

#include "core/error_testing.hpp"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

namespace csrbf::toeplitz_system_test {
namespace {

constexpr double rounding = 1e-13;
constexpr double solved = 1e-9;  // tolerance of the iteration times the condition of the matrices below

// Taps of a kernel with support sigma on a lattice of these steps.
template <int Dim>
std::vector<ToeplitzTap<Dim>> taps_of(const Kernel& kernel, double sigma, const Point<Dim>& step) {
  std::vector<ToeplitzTap<Dim>> taps;
  std::array<Index, Dim> reach{}, k{};
  for (std::size_t a = 0; a < Dim; ++a) reach[a] = static_cast<Index>(sigma / step[static_cast<Index>(a)]);
  for (std::size_t a = 0; a < Dim; ++a) k[a] = -reach[a];
  for (;;) {
    double r2 = 0;
    for (std::size_t a = 0; a < Dim; ++a) r2 += std::pow(static_cast<double>(k[a]) * step[static_cast<Index>(a)], 2);
    if (r2 < sigma * sigma) taps.push_back({k, kernel.value(std::sqrt(r2) / sigma)});
    std::size_t a = 0;
    for (; a < Dim && ++k[a] > reach[a]; ++a) k[a] = -reach[a];
    if (a == Dim) return taps;
  }
}

template <int Dim>
Points<Dim> lattice_points(const std::array<Index, Dim>& size, const Point<Dim>& step) {
  Index n = 1;
  for (const Index length : size) n *= length;
  Points<Dim> points(Dim, n);
  for (Index i = 0; i < n; ++i) {
    Index rest = i;
    for (std::size_t a = 0; a < Dim; ++a) {
      points(static_cast<Index>(a), i) = static_cast<double>(rest % size[a]) * step[static_cast<Index>(a)];
      rest /= size[a];
    }
  }
  return points;
}

template <int Dim>
Eigen::MatrixXd dense(const Kernel& kernel, double sigma, const Points<Dim>& points) {
  Eigen::MatrixXd H(points.cols(), points.cols());
  for (Index i = 0; i < points.cols(); ++i)
    for (Index j = 0; j < points.cols(); ++j) H(i, j) = kernel.value((points.col(i) - points.col(j)).norm() / sigma);
  return H;
}

template <int Dim>
void expect_dense_solution(const std::array<Index, Dim>& size, const Point<Dim>& step, const char* name, double sigma,
                           bool preconditioned) {
  const Kernel kernel(name, Dim);
  const ToeplitzSystem<Dim> system(size, taps_of<Dim>(kernel, sigma, step));
  const Eigen::MatrixXd H = dense<Dim>(kernel, sigma, lattice_points<Dim>(size, step));
  const Eigen::VectorXd x = Eigen::VectorXd::Random(H.rows());
  const Eigen::VectorXd b = H * x;
  EXPECT_LT((system.multiply(x) - b).cwiseAbs().maxCoeff(), rounding * H.rowwise().sum().maxCoeff());
  EXPECT_EQ(system.preconditioned(), preconditioned);
  EXPECT_LT((system.solve(b) - x).norm(), solved * x.norm());
}

TEST(ToeplitzSystem, SolvesTheIdentityInOneStep) {
  const ToeplitzSystem<2> system({5, 4}, {{{0, 0}, 2.0}});
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(20, -1, 3);
  EXPECT_LT((system.solve(b) - b / 2).norm(), rounding);
  EXPECT_EQ(system.iterations(), 1);
  EXPECT_EQ(system.condition(), 1);
}

TEST(ToeplitzSystem, GivesZeroForZero) {
  const ToeplitzSystem<1> system({5}, {{{-1}, .1}, {{0}, 1.0}, {{1}, .1}});
  EXPECT_EQ(system.solve(Eigen::VectorXd::Zero(5)), Eigen::VectorXd::Zero(5));
}

TEST(ToeplitzSystem, AgreesWithTheDenseMatrix) {
  expect_dense_solution<1>({40}, Point<1>(1), "wendland-c2", 3.5, false);
  expect_dense_solution<2>({13, 17}, Point<2>(1, 1), "wendland-c2", 2.83, false);
  expect_dense_solution<2>({13, 17}, Point<2>(1, .7), "wendland-c4", 5.6, true);
  expect_dense_solution<3>({6, 9, 7}, Point<3>(1, 1, 2), "wendland-c2", 2.5, false);
  expect_dense_solution<3>({6, 9, 7}, Point<3>(1, 1, 1.3), "wendland-c4", 4.5, true);
}

TEST(ToeplitzSystem, AgreesWhenTheStencilIsLargerThanTheLattice) {
  expect_dense_solution<2>({3, 4}, Point<2>(1, 1), "wendland-c2", 6.5, true);
}

TEST(ToeplitzSystem, PreconditionsIndependentlyOfTheSize) {
  const auto taps = taps_of<2>(Kernel("wendland-c4", 2), 5.66, Point<2>(1, 1));
  const auto iterations = [&](Index n) {
    const ToeplitzSystem<2> system({n, n}, taps);
    static_cast<void>(system.solve(Eigen::VectorXd::Random(n * n)));
    return system.iterations();
  };
  EXPECT_LE(iterations(80), iterations(40) + 5);
  ToeplitzOptions plain;
  plain.precondition_from = std::numeric_limits<double>::infinity();
  const ToeplitzSystem<2> system({40, 40}, taps, plain);
  static_cast<void>(system.solve(Eigen::VectorXd::Random(1600)));
  EXPECT_GT(system.iterations(), 5 * iterations(40));
}

TEST(ToeplitzSystem, DoesNotDependOnTheNumberOfThreads) {
  const ToeplitzSystem<2> system({150, 140}, taps_of<2>(Kernel("wendland-c4", 2), 4.5, Point<2>(1, 1)));
  const Eigen::VectorXd b = Eigen::VectorXd::Random(150 * 140);
  set_thread_count(1);
  const Eigen::VectorXd one = system.solve(b);
  set_thread_count(3);
  EXPECT_EQ(system.solve(b), one);
  set_thread_count(0);
}

TEST(ToeplitzSystem, RefusesWhatItCannotSolve) {
  EXPECT_NE(invalid_input_message([] { ToeplitzSystem<1>({0}, {{{0}, 1.0}}); }).find("size = 0"), std::string::npos);
  EXPECT_NE(invalid_input_message([] { ToeplitzSystem<1>({3}, {}); }).find("number of taps"), std::string::npos);
  EXPECT_NE(invalid_input_message([] {
              static_cast<void>(ToeplitzSystem<1>({3}, {{{0}, 1.0}}).solve(Eigen::VectorXd::Ones(4)));
            }).find("size of b"),
            std::string::npos);
  const ToeplitzSystem<1> indefinite({8}, {{{-1}, 1.0}, {{0}, 1.0}, {{1}, 1.0}});
  EXPECT_THROW(static_cast<void>(indefinite.solve(
                   Eigen::VectorXd::Ones(8).cwiseProduct(Eigen::VectorXd::LinSpaced(8, 0, 7).array().cos().matrix()))),
               SolverFailure);
}

}  // namespace
}  // namespace csrbf::toeplitz_system_test
