#include "csrbf/levelset/baselines/node_system.hpp"

#include "approx/approx_testing.hpp"
#include "core/error_testing.hpp"

#include <gtest/gtest.h>

#include <string>

namespace csrbf::node_system_test {
namespace {

constexpr double solved = 1e-9;  // rounding times the condition of H

Nodes<2> square_nodes(Index n) {
  Box<2> box;
  box.add(Point<2>(0, 0));
  box.add(Point<2>(1, 1));
  return regular_nodes<2>(box, {n, n});
}

Nodes<2> scattered_nodes(Index n) {
  return {random_points<2>(n, 5)};
}

TEST(Nodes, ReachFromTheFirstToTheLastVoxel) {
  Grid grid;
  grid.axes = 2;
  grid.size = {31, 11, 1};
  grid.spacing = Point<3>(.5, 2, 1);
  grid.origin = Point<3>(10, 20, 0);
  const Nodes<2> nodes = regular_nodes<2>(grid, 5.0);  // 2.5 apart: 15 / 2.5 and 20 / 2.5 steps
  EXPECT_EQ(nodes.size, (std::array<Index, 2>{7, 9}));
  EXPECT_EQ(nodes.points.col(0), Point<2>(10, 20));
  EXPECT_EQ(nodes.points.col(62), Point<2>(25, 40));
  EXPECT_NEAR(fill_distance<2>(nodes, grid.centers<2>()), 2.5 * std::sqrt(.5), 1e-12);
}

TEST(Nodes, FillTheDomainUpToTheLargestHole) {
  Nodes<2> nodes{Points<2>(2, 2)};
  nodes.points << 0, 4, 0, 0;
  Points<2> domain(2, 3);
  domain << 0, 2, 4, 0, 0, 3;
  EXPECT_DOUBLE_EQ(fill_distance<2>(nodes, domain), 3);
}

TEST(NodeSystem, InterpolatesOnRegularAndScatteredNodesByEverySolver) {
  struct Case {
    Nodes<2> nodes;
    const char* kernel;
    double support;
  };
  for (const Case& c :  // sparse, Toeplitz, Toeplitz, sparse, dense
       {Case{square_nodes(20), "wendland-c2", .15}, Case{square_nodes(60), "wendland-c2", .05},
        Case{square_nodes(60), "wendland-c4", .09}, Case{scattered_nodes(3000), "wendland-c2", .03},
        Case{square_nodes(20), "thin-plate", 1}}) {
    const NodeSystem<2> system(c.nodes, Kernel(c.kernel, 2), c.support);
    const Eigen::VectorXd s = random_points<1>(c.nodes.points.cols(), 7).transpose();
    const Eigen::VectorXd mu = system.solve(s);
    EXPECT_LT((system.multiply(mu) - s).cwiseAbs().maxCoeff(), solved);
    EXPECT_LT((system.expansion(mu)->evaluate(c.nodes.points).value - s).cwiseAbs().maxCoeff(), solved);
  }
}

TEST(NodeSystem, AddsDiffusionByTheLaplacianOfTheKernel) {
  const double diffusion = .02;
  for (const Index n : {20, 60}) {
    const Nodes<2> nodes = square_nodes(n);
    const double support = 4.5 / static_cast<double>(n);
    const NodeSystem<2> plain(nodes, Kernel("wendland-c4", 2), support);
    const NodeSystem<2> diffused(nodes, Kernel("wendland-c4", 2), support, diffusion);
    const Eigen::VectorXd mu = random_points<1>(n * n, 7).transpose().array() - .5;
    const Jet<2> jet = plain.expansion(mu)->evaluate(nodes.points, Derivatives::hessian);
    const Eigen::VectorXd laplacian =
        (jet.hessian.row(0) + jet.hessian.row(2)).transpose() + plain.laplacian_bias() * jet.value;
    const Eigen::VectorXd expected = jet.value - diffusion * laplacian;
    const double size = expected.cwiseAbs().maxCoeff();
    EXPECT_LT((diffused.multiply(mu) - expected).cwiseAbs().maxCoeff(), 1e-12 * size);
    EXPECT_LT((diffused.solve(expected) - mu).cwiseAbs().maxCoeff(), solved);
  }
}

TEST(NodeSystem, KnowsTheLaplacianOfTheInterpolantOfAConstant) {
  const Nodes<2> nodes = square_nodes(41);
  const double h = 1.0 / 40;
  for (const double spacings : {2.83, 4.0, 5.5}) {
    const NodeSystem<2> system(nodes, Kernel("wendland-c4", 2), spacings * h);
    const Point<2> middle(.5, .5);  // far from the border
    const auto one = system.expansion(system.solve(Eigen::VectorXd::Ones(41 * 41)));
    const Jet<2> jet = one->evaluate(middle, Derivatives::hessian);
    EXPECT_NEAR(jet.hessian(0, 0) + jet.hessian(2, 0), -system.laplacian_bias(), 1e-4 / (h * h));
  }
  EXPECT_EQ(NodeSystem<2>(scattered_nodes(50), Kernel("wendland-c4", 2), .3).laplacian_bias(), 0);
}

TEST(NodeSystem, HasTheLaplacianOfWavesWithTheBias) {
  const Nodes<2> nodes = square_nodes(41);
  const double h = 1.0 / 40, k = .4 / h;
  constexpr double accuracy = 3e-3;  // what a support of 5.5 spacings has; 1.3e-2 of it is the bias
  const NodeSystem<2> system(nodes, Kernel("wendland-c4", 2), 5.5 * h);
  const Eigen::VectorXd wave = (k * (nodes.points.row(0).array() - .5)).cos().transpose();
  const Jet<2> jet = system.expansion(system.solve(wave))->evaluate(Point<2>(.5, .5), Derivatives::hessian);
  const double laplacian = jet.hessian(0, 0) + jet.hessian(2, 0);
  EXPECT_NEAR((laplacian + system.laplacian_bias()) / (-k * k), 1, accuracy);
  EXPECT_GT(std::abs(laplacian / (-k * k) - 1), 3 * accuracy);
}

TEST(NodeSystem, ReproducesPolynomialsBelowTheOrderOfTheKernel) {
  const Nodes<2> nodes = square_nodes(8);
  const NodeSystem<2> system(nodes, Kernel("thin-plate", 2), 1);
  const Eigen::VectorXd s = (nodes.points.row(0) * 3 - nodes.points.row(1)).transpose().array() + 2;
  EXPECT_LT(system.solve(s).head(64).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(NodeSystem, RefusesWhatItCannotSolve) {
  const auto message = [](const Nodes<2>& nodes, const char* kernel, double support, double diffusion) {
    return invalid_input_message([&] { NodeSystem<2>(nodes, Kernel(kernel, 2), support, diffusion); });
  };
  EXPECT_NE(message(square_nodes(5), "wendland-c2", 0, 0).find("support = 0"), std::string::npos);
  EXPECT_NE(message(square_nodes(5), "wendland-c2", 1, -1).find("diffusion = -1"), std::string::npos);
  EXPECT_NE(message(square_nodes(5), "thin-plate", 1, 1).find("kernel = thin-plate"), std::string::npos);
  EXPECT_NE(message(square_nodes(64), "gaussian", .01, 0).find("number of nodes = 4096"), std::string::npos);
  Nodes<2> wrong = square_nodes(5);
  wrong.size = {5, 4};
  EXPECT_NE(message(wrong, "wendland-c2", 1, 0).find("number of nodes = 25"), std::string::npos);
  Nodes<2> twice = scattered_nodes(50);
  twice.points.col(7) = twice.points.col(30);
  EXPECT_NE(message(twice, "wendland-c2", .3, 0).find("node = 30"), std::string::npos);
  EXPECT_THROW(NodeSystem<2>(square_nodes(10), Kernel("gaussian", 2), 3), SolverFailure);
  EXPECT_NE(invalid_input_message([] {
              static_cast<void>(regular_nodes<2>(Grid{}, {1, 4}));
            }).find("number of nodes along an axis = 1"),
            std::string::npos);
}

}  // namespace
}  // namespace csrbf::node_system_test
