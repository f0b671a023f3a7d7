#include "csrbf/approx/function.hpp"
#include "csrbf/approx/samples/fitted_field.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/core/parallel.hpp"

#include "approx/partition_testing.hpp"
#include "core/error_testing.hpp"
#include "csrbf/core/grid_tiles.hpp"

namespace csrbf::evaluate_grid_test {
namespace {

constexpr double rounding = 1e-12;  // of the sums, in another order

template <int Dim>
GridAxes<Dim> random_axes(const std::array<Index, Dim>& sizes, double lo, double hi) {
  GridAxes<Dim> axes;
  for (std::size_t a = 0; a < Dim; ++a) {
    axes[a] = (lo + (hi - lo) * random_points<1>(sizes[a], 3 + static_cast<unsigned>(a)).array()).transpose();
    std::sort(axes[a].begin(), axes[a].end());
  }
  return axes;
}

template <int Dim>
Points<Dim> nodes_of(const GridAxes<Dim>& axes) {
  const GridTiles<Dim> tiles(axes, 1);
  Points<Dim> nodes(Dim, tiles.nodes());
  for (Index i = 0; i < tiles.size(); ++i)
    tiles.for_each_row(tiles[i], [&](const std::array<Index, Dim>& node, Index first) {
      for (std::size_t a = 0; a < Dim; ++a) nodes(static_cast<Index>(a), first) = axes[a][node[a]];
    });
  return nodes;
}

template <int Dim>
void expect_values_at_nodes(const Field<Dim>& f, const GridAxes<Dim>& axes) {
  const Eigen::VectorXd grid = f.evaluate_grid(axes), points = f.evaluate(nodes_of<Dim>(axes)).value;
  ASSERT_EQ(grid.size(), points.size());
  EXPECT_EQ(grid.array().isNaN().count(), points.array().isNaN().count());
  const double largest = points.array().isNaN().select(0.0, points.array()).abs().maxCoeff();
  for (Index i = 0; i < grid.size(); ++i) {
    if (std::isnan(points[i])) continue;
    EXPECT_NEAR(grid[i], points[i], rounding * largest) << "node " << i;
  }
}

template <int Dim>
void expect_grid_of(const PartitionOfUnityOptions& options, const std::array<Index, Dim>& sizes) {
  const auto f = partition_field<Dim>(sample<Dim>(random_points<Dim>(600, 1), waves<Dim>), options);
  expect_values_at_nodes<Dim>(*f, random_axes<Dim>(sizes, -0.2, 1.2));
}

TEST(EvaluateGrid, EqualsEvaluationAtItsNodesForPolynomials) {
  for (int degree = 0; degree <= 3; ++degree) {
    const PartitionOfUnityOptions options{
        .degree = degree, .samples_per_patch = 40, .centers_per_patch = 0, .smoothing = 0};
    expect_grid_of<1>(options, {300});
    expect_grid_of<2>(options, {90, 31});
    expect_grid_of<3>(options, {20, 33, 9});
  }
  expect_grid_of<5>({.degree = 2, .samples_per_patch = 80, .centers_per_patch = 0, .smoothing = 0}, {5, 4, 6, 3, 5});
}

TEST(EvaluateGrid, EqualsEvaluationAtItsNodesForRadialFunctions) {
  const PartitionOfUnityOptions options{.kernel = "wendland-c4", .degree = 1, .samples_per_patch = 30, .smoothing = 0};
  expect_grid_of<1>(options, {300});
  expect_grid_of<2>(options, {90, 31});
  expect_grid_of<3>(options, {20, 33, 9});
  expect_grid_of<2>({.kernel = "wendland-c2", .degree = -1, .samples_per_patch = 30, .smoothing = 0}, {50, 50});
  expect_grid_of<3>({.degree = 1, .samples_per_patch = 30, .anisotropy = .8, .smoothing = 0}, {20, 33, 9});
  expect_grid_of<2>({.degree = 1, .samples_per_patch = 30, .centers_per_patch = 1, .smoothing = 0}, {50, 50});
  expect_grid_of<2>(options, {1, 1});
}

TEST(EvaluateGrid, TakesCoordinatesInAnyOrderAndMoreThanOnce) {
  const auto f = partition_field<2>(sample<2>(random_points<2>(300, 1), waves<2>));
  GridAxes<2> axes = random_axes<2>({30, 20}, 0, 1);
  axes[1].reverseInPlace();
  expect_values_at_nodes<2>(*f, axes);
  axes[0].setConstant(0.25);
  axes[1].setConstant(f->bounds().hi[1]);
  expect_values_at_nodes<2>(*f, axes);
}

TEST(EvaluateGrid, HasNodesOnTheBordersOfCells) {
  const auto fit = partition_of_unity<2>(sample<2>(random_points<2>(400, 1), waves<2>));
  const Cover<2>& cover = fit.data->cover;
  GridAxes<2> axes{Eigen::VectorXd(cover.size()), Eigen::VectorXd(cover.size())};
  for (Index i = 0; i < cover.size(); ++i)
    for (Index a = 0; a < 2; ++a) axes[a][i] = cover.cell(i).lo[a];
  for (auto& axis : axes) std::sort(axis.begin(), axis.end());
  expect_values_at_nodes<2>(*fit.fields()[0], axes);
}

TEST(EvaluateGrid, FollowsScalesPeriodsAndExtrapolation) {
  Samples<2> samples = sample<2>(random_points<2>(700, 1), waves<2>);
  samples.points.row(1) *= 1000;
  for (const auto extrapolation :
       {Extrapolation::automatic, Extrapolation::constant, Extrapolation::nan, Extrapolation::linear}) {
    const auto f = fit<2>(samples, {.periods = {1, 0}, .extrapolation = extrapolation}).components[0];
    GridAxes<2> axes = random_axes<2>({40, 30}, -0.5, 2.5);
    axes[1] *= 800;
    expect_values_at_nodes<2>(*f, axes);
    axes[0][3] = std::numeric_limits<double>::quiet_NaN();
    expect_values_at_nodes<2>(*f, axes);
  }
}

TEST(EvaluateGrid, DoesNotDependOnTheNumberOfThreads) {
  const auto f = partition_field<3>(sample<3>(random_points<3>(2000, 1), waves<3>));
  const GridAxes<3> axes = random_axes<3>({40, 40, 40}, 0, 1);
  set_thread_count(1);
  const Eigen::VectorXd one = f->evaluate_grid(axes);
  set_thread_count(3);
  EXPECT_EQ(f->evaluate_grid(axes), one);
  set_thread_count(0);
}

TEST(EvaluateGrid, OfNoNodesIsEmpty) {
  const auto f = partition_field<2>(sample<2>(random_points<2>(100, 1), waves<2>));
  EXPECT_EQ(f->evaluate_grid({Eigen::VectorXd(0), Eigen::VectorXd::Zero(3)}).size(), 0);
}

TEST(EvaluateGrid, OfAFunctionHasAColumnForEachOfItsValues) {
  const Points<2> points = random_points<2>(800, 1);
  Eigen::MatrixXd values(800, 2);
  values << points.row(0).transpose(), 2 * points.row(1).transpose();
  const Function f = fit_function(points, values, Eigen::VectorXd(), {.method = "partition-of-unity"});
  const GridAxes<2> axes = random_axes<2>({7, 5}, 0.1, 0.9);
  const Eigen::MatrixXd grid = f.evaluate_grid({axes[0], axes[1]});
  constexpr double exact = 1e-9;  // of functions that the local polynomials hold
  EXPECT_LE((grid - f.evaluate(nodes_of<2>(axes)).value).cwiseAbs().maxCoeff(), rounding);
  EXPECT_NEAR(grid(3, 0), axes[0][3], exact);
  EXPECT_NEAR(grid(3 * 7, 1), 2 * axes[1][3], exact);
  EXPECT_EQ(invalid_input_message([&] { (void)f.evaluate_grid({axes[0]}); }),
            "evaluate_grid: number of axes = 1: must be 2, the dimension of the function");
}

TEST(EvaluateGrid, IntoMemoryOfTheCallerGivesTheSameValuesInSlices) {
  const Points<2> points = random_points<2>(800, 1);
  Eigen::MatrixXd values(800, 2);
  values << points.row(0).transpose(), 2 * points.row(1).transpose();
  const Function f = fit_function(points, values, Eigen::VectorXd(), {.method = "partition-of-unity"});
  const GridAxes<2> axes = random_axes<2>({1500, 1400}, 0, 1);  // two slices and a rest
  const std::vector<Eigen::VectorXd> given{axes[0], axes[1]};
  const Eigen::MatrixXd expected = f.evaluate_grid(given).transpose();
  Eigen::MatrixXd out(2, 1500 * 1400);
  std::vector<double> fractions;
  f.evaluate_grid(given, out, [&](std::string_view stage, double fraction) {
    EXPECT_EQ(stage, "evaluate");
    fractions.push_back(fraction);
    return true;
  });
  EXPECT_EQ(out, expected);
  EXPECT_EQ(fractions.size(), 3U);
  Eigen::MatrixXf single(2, 1500 * 1400);
  f.evaluate_grid(given, single);
  EXPECT_EQ(single, expected.cast<float>());
  EXPECT_THROW(f.evaluate_grid(given, out, [](std::string_view, double fraction) { return fraction == 0; }), Cancelled);
  Eigen::MatrixXd small(2, 3);
  EXPECT_EQ(invalid_input_message([&] { f.evaluate_grid(given, small); }),
            "evaluate_grid: columns of values = 3: must be 2100000, the nodes of the grid");
  Eigen::MatrixXd flat(1, 1500 * 1400);
  EXPECT_EQ(invalid_input_message([&] { f.evaluate_grid(given, flat); }),
            "evaluate_grid: rows of values = 1: must be 2, the components of the function");
  EXPECT_EQ(invalid_input_message([&] { f.evaluate_grid({axes[0]}, out); }),
            "evaluate_grid: number of axes = 1: must be 2, the dimension of the function");
  Eigen::MatrixXd none(2, 0);
  f.evaluate_grid({Eigen::VectorXd(0), axes[1]}, none);
}

}  // namespace
}  // namespace csrbf::evaluate_grid_test
