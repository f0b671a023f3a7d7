#include "csrbf/levelset/baselines/collocation.hpp"

#include "approx/approx_testing.hpp"
#include "core/error_testing.hpp"
#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/levelset/baselines/node_system.hpp"
#include "levelset/levelset_testing.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace csrbf::collocation_test {
namespace {

template <int Dim>
const Expansion<Dim>& expansion(const CollocationResult<Dim>& result) {
  return dynamic_cast<const Expansion<Dim>&>(*result.field);
}

constexpr double rounding = 1e-12;

// An image of noise 15 around 60 and 200, and a disc far off the object as start.
struct Segmentation {
  TestImage image = holed_disc(100, 15);
  std::vector<unsigned char> start = ball_labels(image.grid, Point<3>(25, 30, 0), 18);
  std::vector<double> energies;

  CollocationResult<2> run(double spacing, const CollocationOptions& options = {}) {
    return collocate<2>(image.grid, regular_nodes<2>(image.grid, spacing), start.data(),
                        chan_vese_force(image.values, &energies), options);
  }
};

double delta(double f, double eps) {
  return 1 / (std::numbers::pi * eps * (1 + f * f / (eps * eps)));
}

// Labels of the image thresholded where two means are as likely, iterated to the fixed point.
std::vector<unsigned char> two_means(const std::vector<float>& values, std::vector<unsigned char> labels) {
  for (int i = 0; i < 100; ++i) {
    const Means C = means_of(values, labels.data());
    for (std::size_t k = 0; k < values.size(); ++k)
      labels[k] =
          std::abs(static_cast<double>(values[k]) - C.inside) < std::abs(static_cast<double>(values[k]) - C.outside);
  }
  return labels;
}

TEST(Collocation, IsAnOrdinaryDifferentialEquationAtEachNode) {
  // Nodes on all voxels, so that the equation needs neither averages nor interpolation; few enough for a factor.
  const Grid grid = square_grid(40);
  const Nodes<2> nodes = regular_nodes<2>(grid, 1.0);
  const Eigen::VectorXd V = random_points<1>(1600, 4).transpose().array() - .5;
  const auto field = make_expansion<2>(Kernel("gaussian", 2), Point<2>(17, 21), Eigen::VectorXd::Constant(1, 12.0),
                                       Eigen::VectorXd::Constant(1, 2.0));
  CollocationOptions options;
  options.bound = LevelSetBound::none;
  options.sampling = VelocitySampling::nearest_voxel;
  options.eps = 1.3;
  options.step = .1;
  options.iterations = 20;
  const auto force = [&](const unsigned char*, float* out) {
    for (Index i = 0; i < V.size(); ++i) out[i] = static_cast<float>(V[i]);
  };
  const CollocationResult<2> result = collocate<2>(grid, nodes, *field, force, options);
  Eigen::VectorXd s = field->evaluate(nodes.points).value;
  const double tau = .1 * std::numbers::pi * 1.3, largest = static_cast<double>(V.cast<float>().cwiseAbs().maxCoeff());
  EXPECT_NEAR(result.tau, tau, rounding);
  for (int step = 0; step < result.iterations; ++step)
    for (Index i = 0; i < s.size(); ++i)
      s[i] -= tau * static_cast<double>(static_cast<float>(V[i])) / largest * delta(s[i], 1.3);
  EXPECT_LT((result.field->evaluate(nodes.points).value - s).cwiseAbs().maxCoeff(), rounding);
}

TEST(Collocation, ThresholdsATwoLevelImageMidwayBetweenItsLevels) {
  Segmentation test;
  test.image = holed_disc(100, 0);
  CollocationOptions options;
  options.sampling = VelocitySampling::nearest_voxel;
  const CollocationResult<2> result = test.run(1.0, options);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.labels, test.image.truth);
  EXPECT_EQ(result.gaps.back(), 0);
}

TEST(Collocation, IsTwoMeansClusteringOfTheVoxels) {
  Segmentation test;
  CollocationOptions options;
  options.sampling = VelocitySampling::nearest_voxel;
  for (const LevelSetBound bound : {LevelSetBound::none, LevelSetBound::cap, LevelSetBound::l1_norm}) {
    options.bound = bound;
    const CollocationResult<2> result = test.run(1.0, options);
    EXPECT_TRUE(result.converged);
    // Voxels of almost no force creep: with a bound that leaves f some height they are the last to change.
    const double agreement = dice(result.labels, two_means(test.image.values, test.start));
    EXPECT_GE(agreement, bound == LevelSetBound::l1_norm ? 1 : .998);
  }
}

TEST(Collocation, NeverRaisesTheEnergyOfTwoMeansWhereEachVoxelIsANode) {
  Segmentation test;
  CollocationOptions options;
  options.sampling = VelocitySampling::nearest_voxel;
  options.step = .2;
  for (const double eps : {0.0, 1.3}) {
    options.eps = eps;
    test.energies.clear();
    static_cast<void>(test.run(1.0, options));
    ASSERT_GT(test.energies.size(), 3u);
    for (std::size_t i = 1; i < test.energies.size(); ++i)
      EXPECT_LE(test.energies[i], test.energies[i - 1] * (1 + rounding));
    EXPECT_LT(test.energies.back(), .5 * test.energies.front());
  }
}

TEST(Collocation, FindsANoisyDiscWithHolesFromADiscBesideIt) {
  for (const double spacing : {1.0, 2.0}) {
    for (const LevelSetBound bound : {LevelSetBound::none, LevelSetBound::cap, LevelSetBound::l1_norm}) {
      Segmentation test;
      CollocationOptions options;
      options.bound = bound;
      const CollocationResult<2> result = test.run(spacing, options);
      EXPECT_TRUE(result.converged);
      EXPECT_GT(dice(result.labels, test.image.truth), bound == LevelSetBound::none ? .985 : .99);
    }
  }
}

TEST(Collocation, MovesTheContourOnlyWhenDeltaIsNarrow) {
  Segmentation test;
  test.start = ball_labels(test.image.grid, Point<3>(50, 70, 0), 8);  // inside the object, beside the holes
  CollocationOptions options;
  options.eps = 1.25;
  options.iterations = 400;
  const CollocationResult<2> local = test.run(2.0, options);
  EXPECT_GT(dice(local.labels, test.image.truth), .98);
  EXPECT_GT(local.iterations, test.run(2.0).iterations);
}

TEST(Collocation, DoesNotFlipBetweenTwoStates) {
  for (const double step : {.1, 1.0, 10.0}) {
    Segmentation test;
    CollocationOptions options;
    options.bound = LevelSetBound::l1_norm;
    options.step = step;
    const CollocationResult<2> result = test.run(2.0, options);
    ASSERT_TRUE(result.converged);
    EXPECT_LT(result.iterations, 50);
    EXPECT_GT(dice(result.labels, test.image.truth), .99);
  }
}

TEST(Collocation, GivesTheSameForEveryLargeTimeStepUnderTheNormalisation) {
  Segmentation test;
  CollocationOptions options;
  options.bound = LevelSetBound::l1_norm;
  options.step = .1;
  const std::vector<unsigned char> labels = test.run(2.0, options).labels;
  for (const double step : {1.0, 10.0}) {
    options.step = step;
    EXPECT_GT(dice(test.run(2.0, options).labels, labels), .999);
  }
}

TEST(Collocation, NormalisesTheCoefficientsToTheSupport) {
  Segmentation test;
  CollocationOptions options;
  options.bound = LevelSetBound::l1_norm;
  const CollocationResult<2> result = test.run(2.5, options);
  EXPECT_NEAR(expansion(result).coefficients().lpNorm<1>(), result.support, rounding * result.support);
  // |f| <= phi(0) |alpha|_1, extremely loose, and |grad f| <= K' |alpha|_1 / sigma, K' = 135 / 64 of phi_{3,1}.
  const Jet<2> jet = result.field->evaluate(test.image.grid.centers<2>(), Derivatives::gradient);
  EXPECT_LT(jet.value.cwiseAbs().maxCoeff(), .05 * result.support);
  EXPECT_LE(jet.gradient.colwise().norm().maxCoeff(), 135.0 / 64);
}

TEST(Collocation, HasNoBetterBoundOfTheGradientThanThatOfOneFunction) {
  const auto f = make_expansion<2>(Kernel("wendland-c2", 2), Point<2>(0, 0), Eigen::VectorXd::Constant(1, 3.0),
                                   Eigen::VectorXd::Constant(1, 2.0));
  const Jet<2> jet = f->evaluate(Point<2>(.75, 0), Derivatives::gradient);  // the steepest radius, sigma / 4
  EXPECT_NEAR(jet.gradient.norm(), 135.0 / 64 * 2 / 3, rounding);
}

TEST(Collocation, CapsTheValuesAtTheNodes) {
  Segmentation test;
  CollocationOptions options;
  options.largest_value = 2;
  const CollocationResult<2> result = test.run(2.0, options);
  const Nodes<2> nodes = regular_nodes<2>(test.image.grid, 2.0);
  EXPECT_NEAR(result.field->evaluate(nodes.points).value.cwiseAbs().maxCoeff(), 2 * result.node_spacing, 1e-9);
}

// Figure 8.5: without a bound the coefficients go on changing when the contour has come to rest.
TEST(Collocation, ChangesCoefficientsForeverWithoutABound) {
  Segmentation test;
  const auto last_change = [&](LevelSetBound bound) {
    CollocationOptions options;
    options.bound = bound;
    const CollocationResult<2> result = test.run(2.0, options);
    EXPECT_TRUE(result.converged);
    return result.coefficient_changes.back() / expansion(result).coefficients().lpNorm<Eigen::Infinity>();
  };
  EXPECT_GT(last_change(LevelSetBound::none), 1e-2);
  EXPECT_LT(last_change(LevelSetBound::l1_norm), 1e-4);
}

// Appendix D takes (8.28) for a projection that brings points closer together; it can move them apart.
TEST(Collocation, ShowsThatRadialScalingExpandsTheL1Norm) {
  const Eigen::Vector2d a(1, 0), b(1, .1);
  const Eigen::Vector2d Pa = a / a.lpNorm<1>(), Pb = b / b.lpNorm<1>();
  EXPECT_NEAR((a - b).lpNorm<1>(), .1, rounding);
  EXPECT_NEAR((Pa - Pb).lpNorm<1>(), .2 / 1.1, rounding);  // .1818
}

TEST(Collocation, WorksWithEveryKernel) {
  Segmentation test;
  test.image = holed_disc(60, 15);
  test.start = ball_labels(test.image.grid, Point<3>(15, 18, 0), 11);
  for (const std::string& name : Kernel::names(2)) {
    CollocationOptions options;
    options.kernel = name;
    SCOPED_TRACE(name);
    // The matrix of |r|^7 is singular to working precision on more nodes.
    const CollocationResult<2> result = test.run(name == "septic" ? 5.0 : 3.0, options);
    EXPECT_GT(dice(result.labels, test.image.truth), name == "septic" ? .9 : .95);
    EXPECT_EQ(expansion(result).basis().kernel().name(), name);
  }
}

TEST(Collocation, TakesIrregularNodesDenserAtTheBoundary) {
  Segmentation test;
  // Every fourth pixel, and every pixel within 3 of the object's border.
  const std::vector<unsigned char>& truth = test.image.truth;
  std::vector<Index> chosen;
  const Grid& grid = test.image.grid;
  for (Index i = 0; i < grid.voxels(); ++i) {
    const Index x = i % grid.size[0], y = i / grid.size[0];
    bool border = false;
    for (Index dy = -3; dy <= 3; ++dy)
      for (Index dx = -3; dx <= 3; ++dx) {
        const Index nx = std::clamp<Index>(x + dx, 0, 99), ny = std::clamp<Index>(y + dy, 0, 99);
        border = border || truth[grid.index(nx, ny)] != truth[i];
      }
    if (border || (x % 4 == 0 && y % 4 == 0)) chosen.push_back(i);
  }
  const Points<2> centers = grid.centers<2>();
  const Nodes<2> nodes{centers(Eigen::all, chosen)};
  ASSERT_LT(nodes.points.cols(), 3000);
  CollocationOptions options;
  options.support = 3;
  const auto irregular = collocate<2>(grid, nodes, test.start.data(), chan_vese_force(test.image.values), options);
  EXPECT_GT(dice(irregular.labels, truth), .985);
}

TEST(Collocation, SegmentsABallOnAnisotropicVoxels) {
  Grid grid;
  grid.size = {30, 28, 16};
  grid.spacing = Point<3>(1, 1, 2);
  grid.origin = Point<3>(-5, 3, 100);
  const TestImage image = two_level_image(
      grid, [](const Point<3>& p) { return 9 - (p - Point<3>(10, 16, 115)).norm(); }, 2, 1, .2);
  const std::vector<unsigned char> start = ball_labels(grid, Point<3>(8, 15, 112), 5);
  const CollocationResult<3> result =
      collocate<3>(grid, regular_nodes<3>(grid, 1.5), start.data(), chan_vese_force(image.values));
  EXPECT_TRUE(result.converged);
  EXPECT_GT(dice(result.labels, image.truth), .97);
  EXPECT_GT((*result.field)(Point<3>(10, 16, 115)), 0);
  EXPECT_LT((*result.field)(Point<3>(20, 16, 115)), 0);
}

TEST(Collocation, DoesNotDependOnTheScaleOfTheImage) {
  Segmentation test;
  const std::vector<unsigned char> labels = test.run(2.0).labels;
  for (float& value : test.image.values) value = 7 - value / 64;
  EXPECT_EQ(test.run(2.0).labels, labels);
}

TEST(Collocation, DoesNotDependOnTheNumberOfThreads) {
  Segmentation test;
  set_thread_count(1);
  const CollocationResult<2> one = test.run(1.5);
  set_thread_count(3);
  const CollocationResult<2> three = test.run(1.5);
  set_thread_count(0);
  EXPECT_EQ(expansion(one).coefficients(), expansion(three).coefficients());
  EXPECT_EQ(one.labels, three.labels);
}

TEST(Collocation, StartsFromAField) {
  Segmentation test;
  const Nodes<2> nodes = regular_nodes<2>(test.image.grid, 2.0);
  CollocationOptions options;
  const CollocationResult<2> first = test.run(2.0);
  const CollocationResult<2> again =
      collocate<2>(test.image.grid, nodes, *first.field, chan_vese_force(test.image.values), options);
  EXPECT_GT(dice(again.labels, first.labels), .999);
  EXPECT_LT(again.iterations, first.iterations);
}

TEST(Collocation, RefusesInvalidOptions) {
  Segmentation test;
  const auto message = [&](auto change) {
    CollocationOptions options;
    change(options);
    return invalid_input_message([&] { static_cast<void>(test.run(5.0, options)); });
  };
  using O = CollocationOptions;
  EXPECT_NE(message([](O& o) { o.kernel = "no"; }).find("no"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.support = -1; }).find("support = -1"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.eps = -1; }).find("eps = -1"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.step = 0; }).find("step = 0"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.largest_value = 0; }).find("largest_value = 0"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.iterations = -1; }).find("iterations = -1"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.tolerance = -1; }).find("tolerance = -1"), std::string::npos);
  test.image.values[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(message([](O&) {}).find("force = "), std::string::npos);
  Grid volume;
  volume.size = {4, 4, 4};
  const std::vector<unsigned char> labels(64, 0);
  EXPECT_NE(invalid_input_message([&] {
              static_cast<void>(collocate<2>(volume, regular_nodes<2>(square_grid(4), 1.0), labels.data(),
                                             chan_vese_force(test.image.values)));
            }).find("dimension of the image = 3"),
            std::string::npos);
}

TEST(Collocation, CanBeCancelled) {
  Segmentation test;
  CollocationOptions options;
  options.progress = [](std::string_view, double) { return false; };
  EXPECT_THROW(static_cast<void>(test.run(5.0, options)), Cancelled);
}

}  // namespace
}  // namespace csrbf::collocation_test
