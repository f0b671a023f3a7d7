#include "csrbf/levelset/baselines/finite_difference.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/levelset/lattice/lattice_field.hpp"
#include "levelset/levelset_testing.hpp"

#include <gtest/gtest.h>

namespace csrbf::finite_difference_test {
namespace {

// Discs in rows and columns, so that contours lie everywhere.
std::vector<unsigned char> scattered_discs(const Grid& grid) {
  std::vector<unsigned char> labels;
  const Points<3> p = grid.centers<3>();
  for (Index i = 0; i < p.cols(); ++i) labels.push_back(std::sin(.5 * p(0, i)) * std::sin(.5 * p(1, i)) > 0 ? 1 : 0);
  return labels;
}

TEST(FiniteDifference, FindsATwoLevelDiscExactly) {
  const TestImage image = two_level_image(
      square_grid(80), [](const Point<3>& p) { return 25 - (p - Point<3>(40, 37, 0)).norm(); }, 2, 1, 0);
  const auto start = ball_labels(image.grid, Point<3>(30, 45, 0), 9);
  const FiniteDifferenceResult<2> result =
      finite_difference<2>(image.grid, start.data(), chan_vese_force(image.values));
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.labels, image.truth);
  EXPECT_EQ(result.gaps.back(), 0);
}

TEST(FiniteDifference, FindsANoisyDiscWithHoles) {
  const TestImage image = holed_disc(100, 15);
  const auto start = scattered_discs(image.grid);
  for (const double band : {0.0, 6.0}) {
    FiniteDifferenceOptions options;
    options.band = band;
    options.length = .2;
    const FiniteDifferenceResult<2> result =
        finite_difference<2>(image.grid, start.data(), chan_vese_force(image.values), options);
    EXPECT_TRUE(result.converged);
    EXPECT_GT(dice(result.labels, image.truth), .99);
  }
}

TEST(FiniteDifference, NeedsNoReinitialisationWithThePenalty) {
  const TestImage image = holed_disc(100, 15);
  const auto start = scattered_discs(image.grid);
  FiniteDifferenceOptions options;
  options.band = 0;
  options.reinitialize_every = 0;
  options.penalty = .1;
  options.length = .2;
  const FiniteDifferenceResult<2> result =
      finite_difference<2>(image.grid, start.data(), chan_vese_force(image.values), options);
  EXPECT_GT(dice(result.labels, image.truth), .985);
}

TEST(FiniteDifference, DoesNotReachWhatItsStartDoesNotTouch) {
  // Two discs, the start in one of them: the baseline finds only that.
  const auto disc = [](const Point<3>& p, double x) { return 12 - (p - Point<3>(x, 40, 0)).norm(); };
  const TestImage image = two_level_image(
      square_grid(80), [&](const Point<3>& p) { return std::max(disc(p, 22), disc(p, 58)); }, 2, 1, .05);
  const auto start = ball_labels(image.grid, Point<3>(22, 40, 0), 6);
  const FiniteDifferenceResult<2> result =
      finite_difference<2>(image.grid, start.data(), chan_vese_force(image.values));
  EXPECT_NEAR(dice(result.labels, image.truth), 2.0 / 3, .02);
}

TEST(FiniteDifference, SegmentsABallOnAnisotropicVoxels) {
  Grid grid;
  grid.size = {30, 28, 16};
  grid.spacing = Point<3>(1, 1, 2);
  grid.origin = Point<3>(-5, 3, 100);
  const Point<3> center(10, 16, 115);
  const TestImage image = two_level_image(
      grid, [&](const Point<3>& p) { return 9 - (p - center).norm(); }, 2, 1, .2);
  const auto start = ball_labels(grid, Point<3>(9, 15, 114), 4);
  FiniteDifferenceOptions options;
  options.length = .2;
  const FiniteDifferenceResult<3> result =
      finite_difference<3>(grid, start.data(), chan_vese_force(image.values), options);
  EXPECT_GT(dice(result.labels, image.truth), .97);
  EXPECT_GT((*result.field)(center), 0);
  EXPECT_LT((*result.field)(center + Point<3>(11.5, 0, 0)), 0);
}

TEST(FiniteDifference, InterpolatesItsValuesByAField) {
  const TestImage image = holed_disc(60, 15);
  const auto start = ball_labels(image.grid, Point<3>(30, 28, 0), 25);
  const FiniteDifferenceResult<2> result =
      finite_difference<2>(image.grid, start.data(), chan_vese_force(image.values));
  const Eigen::VectorXd value = result.field->evaluate(image.grid.centers<2>()).value;
  constexpr double accuracy = 1e-3;  // of the interpolation, in voxels
  for (Index i = 0; i < value.size(); ++i)
    EXPECT_NEAR(value[i], std::clamp(static_cast<double>(result.values[i]), -3.0, 3.0), accuracy);
}

TEST(FiniteDifference, RemovesSmallPartsByTheLength) {
  const TestImage image = two_level_image(
      square_grid(60),
      [](const Point<3>& p) {
        return std::max(15 - (p - Point<3>(25, 30, 0)).norm(), 2 - (p - Point<3>(50, 30, 0)).norm());
      },
      2, 1, 0);
  FiniteDifferenceOptions options;
  options.length = 4;
  const FiniteDifferenceResult<2> result =
      finite_difference<2>(image.grid, image.truth.data(), chan_vese_force(image.values), options);
  EXPECT_EQ(result.labels[image.grid.index(50, 30)], 0);
  EXPECT_EQ(result.labels[image.grid.index(25, 30)], 1);
}

TEST(FiniteDifference, StopsWhereThereIsNoForce) {
  const Grid grid = square_grid(20);
  const auto start = ball_labels(grid, Point<3>(10, 10, 0), 5);
  const FiniteDifferenceResult<2> result = finite_difference<2>(
      grid, start.data(), [](const unsigned char*, float* force) { std::fill_n(force, 400, 0.F); });
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.labels, start);
}

TEST(FiniteDifference, DoesNotDependOnTheNumberOfThreads) {
  const TestImage image = holed_disc(80, 15);
  const auto start = ball_labels(image.grid, Point<3>(40, 38, 0), 33);
  const auto run = [&](int threads) {
    set_thread_count(threads);
    const FiniteDifferenceResult<2> result =
        finite_difference<2>(image.grid, start.data(), chan_vese_force(image.values));
    set_thread_count(0);
    return result.values;
  };
  EXPECT_EQ(run(1), run(3));
}

TEST(FiniteDifference, RefusesInvalidOptions) {
  const TestImage image = holed_disc(20, 15);
  const auto start = ball_labels(image.grid, Point<3>(10, 10, 0), 5);
  const auto message = [&](auto change) {
    FiniteDifferenceOptions options;
    change(options);
    return invalid_input_message([&] {
      static_cast<void>(finite_difference<2>(image.grid, start.data(), chan_vese_force(image.values), options));
    });
  };
  using O = FiniteDifferenceOptions;
  EXPECT_NE(message([](O& o) { o.length = -1; }).find("length = -1"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.band = 2; }).find("band = 2"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.reinitialize_every = -1; }).find("reinitialize_every = -1"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.reinitialize_every = 0; }).find("with a band"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.penalty = -1; }).find("penalty = -1"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.iterations = -1; }).find("iterations = -1"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.tolerance = -1; }).find("tolerance = -1"), std::string::npos);
  const auto fails = [&](const Grid& grid, const std::vector<unsigned char>& labels, const ForceUpdate& force) {
    return invalid_input_message([&] { static_cast<void>(finite_difference<2>(grid, labels.data(), force)); });
  };
  const ForceUpdate force = chan_vese_force(image.values);
  EXPECT_NE(fails(image.grid, std::vector<unsigned char>(400, 0), force).find("voxels inside the start = 0"),
            std::string::npos);
  EXPECT_NE(fails(image.grid, std::vector<unsigned char>(400, 1), force).find("voxels inside the start = 400"),
            std::string::npos);
  EXPECT_NE(fails(image.grid, start, [](const unsigned char*, float* out) { std::fill_n(out, 400, std::nanf("")); })
                .find("force = "),
            std::string::npos);
  Grid line = square_grid(20);
  line.size = {400, 1, 1};
  EXPECT_NE(fails(line, start, force).find("dimension of the image = 1"), std::string::npos);
}

TEST(FiniteDifference, CanBeCancelled) {
  const TestImage image = holed_disc(20, 15);
  const auto start = ball_labels(image.grid, Point<3>(10, 10, 0), 5);
  FiniteDifferenceOptions options;
  options.progress = [](std::string_view, double) { return false; };
  EXPECT_THROW(
      static_cast<void>(finite_difference<2>(image.grid, start.data(), chan_vese_force(image.values), options)),
      Cancelled);
}

}  // namespace
}  // namespace csrbf::finite_difference_test
