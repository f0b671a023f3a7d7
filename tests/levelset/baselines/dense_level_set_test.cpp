#include "csrbf/levelset/baselines/dense_level_set.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"
#include "levelset/levelset_testing.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace csrbf::dense_level_set_test {
namespace {

constexpr double whole = std::numeric_limits<double>::infinity();

// n^Dim voxels over [-1, 1]^Dim, but for axes of other edges.
template <int Dim>
Grid cube_grid(Index n, double stretch = 1) {
  Grid grid;
  grid.axes = Dim;
  const double h = 2 / static_cast<double>(n - 1);
  for (std::size_t a = 0; a < Dim; ++a) {
    const auto axis = static_cast<Index>(a);
    const double factor = a == 0 ? stretch : 1;
    grid.spacing[axis] = factor * h;
    grid.size[a] = std::lround(static_cast<double>(n - 1) / factor) + 1;
    grid.origin[axis] = -.5 * grid.spacing[axis] * static_cast<double>(grid.size[a] - 1);
  }
  return grid;
}

std::vector<float> sampled(const Grid& grid, const std::function<double(const Point<3>&)>& f) {
  std::vector<float> values;
  const Points<3> p = grid.centers<3>();
  for (Index i = 0; i < p.cols(); ++i) values.push_back(static_cast<float>(f(p.col(i))));
  return values;
}

template <int Dim>
std::function<double(const Point<3>&)> ball(double radius) {
  return [radius](const Point<3>& p) { return radius - p.head<Dim>().norm(); };
}

// Volume inside by linear interpolation across each voxel, a disc's or ball's radius from it.
template <int Dim>
double radius_of(const Grid& grid, const std::vector<float>& f) {
  const double h = grid.spacing.head<Dim>().minCoeff();
  double volume = 0;
  for (const float value : f) volume += std::clamp(.5 + static_cast<double>(value) / h, 0.0, 1.0);
  volume *= grid.spacing.head<Dim>().prod();
  return Dim == 2 ? std::sqrt(volume / std::numbers::pi) : std::cbrt(3 * volume / (4 * std::numbers::pi));
}

template <int Dim>
void advance(DenseLevelSet<Dim>& f, double duration, double speed, DenseMotion motion, int reinitialize_every = 0) {
  const std::vector<float> speeds(f.values().size(), static_cast<float>(speed));
  motion.speed = speeds.data();
  double time = 0;
  for (int k = 1; time < duration; ++k) {
    const double tau = std::min(duration - time, f.stable_step(std::abs(speed), motion));
    f.step(motion, tau);
    time += tau;
    if (duration - time < 1e-12 * duration) break;
    if (reinitialize_every > 0 && k % reinitialize_every == 0) f.reinitialize(12, reinitialize_every);
  }
}

double order(double coarse, double fine) {
  return std::log2(coarse / fine);
}

TEST(DenseLevelSet, GrowsACircleAtUnitSpeed) {
  std::array<double, 2> error{};
  for (std::size_t i = 0; i < 2; ++i) {
    const Grid grid = cube_grid<2>(i == 0 ? 61 : 121);
    DenseLevelSet<2> f(grid, sampled(grid, ball<2>(.3)), whole);
    advance(f, .3, 1, {});
    error[i] = std::abs(radius_of<2>(grid, f.values()) - .6);
  }
  EXPECT_LT(error[1], .01);
  EXPECT_GT(order(error[0], error[1]), .9);
}

TEST(DenseLevelSet, ShrinksACircleAtNegativeSpeedOnAnisotropicVoxels) {
  const Grid grid = cube_grid<2>(121, 1.5);
  DenseLevelSet<2> f(grid, sampled(grid, ball<2>(.7)), whole);
  advance(f, .3, -1, {});
  EXPECT_NEAR(radius_of<2>(grid, f.values()), .4, .01);
}

TEST(DenseLevelSet, ShrinksACircleByItsCurvature) {
  const double t = .08, radius = std::sqrt(.25 - 2 * t);
  std::array<double, 3> error{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Grid grid = cube_grid<2>(std::array<Index, 3>{21, 41, 81}[i]);
    DenseLevelSet<2> f(grid, sampled(grid, ball<2>(.5)), whole);
    advance(f, t, 0, {nullptr, 1, 0});
    // Far from |grad f| = 1: the radius along the axis.
    const Index middle = grid.size[0] / 2;
    double previous = 0;
    for (Index x = middle; x < grid.size[0]; ++x) {
      const auto value = static_cast<double>(f.values()[grid.index(x, middle)]);
      if (value <= 0) {
        error[i] =
            std::abs((static_cast<double>(x - middle) - 1 + previous / (previous - value)) * grid.spacing[0] - radius);
        break;
      }
      previous = value;
    }
  }
  EXPECT_LT(error[2], 1e-3);
  EXPECT_GT(order(error[0], error[2]), 2 * 1.5) << error[0] << " " << error[1] << " " << error[2];  // two halvings
}

TEST(DenseLevelSet, ShrinksASphereByItsCurvatures) {
  const double t = .03, radius = std::sqrt(.25 - 4 * t);
  const Grid grid = cube_grid<3>(41);
  DenseLevelSet<3> f(grid, sampled(grid, ball<3>(.5)), whole);
  advance(f, t, 0, {nullptr, 1, 0}, 20);
  EXPECT_NEAR(radius_of<3>(grid, f.values()), radius, .01);
}

TEST(DenseLevelSet, MovesInANarrowBandAsInTheWholeImage) {
  const Grid grid = cube_grid<2>(81);
  DenseLevelSet<2> all(grid, sampled(grid, ball<2>(.3)), whole), narrow(grid, sampled(grid, ball<2>(.3)), 6 * .025);
  EXPECT_LT(narrow.active().size(), all.active().size() / 3);
  advance(all, .4, 1, {}, 5);
  advance(narrow, .4, 1, {}, 5);
  EXPECT_NEAR(radius_of<2>(grid, narrow.values()), radius_of<2>(grid, all.values()), 1e-3);
  EXPECT_NEAR(radius_of<2>(grid, narrow.values()), .7, .01);
}

TEST(DenseLevelSet, BecomesADistanceWithoutMovingItsZeros) {
  const Grid grid = cube_grid<2>(101);
  const auto distorted = [](const Point<3>& p) {
    return (.5 - p.head<2>().norm()) * (1.5 + std::sin(3 * p[0]) + .4 * std::cos(5 * p[1]));
  };
  DenseLevelSet<2> f(grid, sampled(grid, distorted), .2);
  const double before = radius_of<2>(grid, sampled(grid, ball<2>(.5)));
  f.reinitialize(40, 8);
  const std::vector<float> exact = sampled(grid, ball<2>(.5));
  double largest = 0;
  for (const Index i : f.active()) {
    const double d = static_cast<double>(exact[i]);
    if (std::abs(d) < .15) largest = std::max(largest, std::abs(static_cast<double>(f.values()[i]) - d));
  }
  EXPECT_LT(largest, .02);  // one voxel edge
  EXPECT_NEAR(radius_of<2>(grid, f.values()), before, 1e-3);
  const double once = radius_of<2>(grid, f.values());
  for (int k = 0; k < 20; ++k) f.reinitialize(10);
  EXPECT_NEAR(radius_of<2>(grid, f.values()), once, 2e-3);
}

// The descent direction of int (|grad f| - 1)^2 / 2, eq. (7.18), against differences of that energy.
TEST(DenseLevelSet, HasThePenaltyOfLiForGradientsOtherThanOne) {
  Grid grid;
  grid.axes = 2;
  grid.size = {401, 401, 1};
  grid.spacing = Point<3>(.02, .02, 1);
  grid.origin = Point<3>(-4, -4, 0);
  const auto value = [](const Point<3>& p) {
    return 1.5 - 1.3 * std::sqrt(p.head<2>().squaredNorm() + .5) + .2 * std::sin(2 * p[0]) * std::cos(p[1]);
  };
  const auto eta = [](const Point<3>& p) { return std::exp(-3 * std::pow(p[0] - .7, 2) - 3 * std::pow(p[1] + .5, 2)); };
  // In double precision: differences of energies of the continuous function.
  const auto energy = [&](double t) {
    constexpr double d = 1e-4;
    double sum = 0;
    for (Index i = 0; i < grid.voxels(); i += 1) {
      const Point<3> p(-4 + .02 * static_cast<double>(i % 401), -4 + .02 * static_cast<double>(i / 401), 0);
      const auto f = [&](double x, double y) {
        const Point<3> q(x, y, 0);
        return value(q) + t * eta(q);
      };
      const double fx = (f(p[0] + d, p[1]) - f(p[0] - d, p[1])) / (2 * d);
      const double fy = (f(p[0], p[1] + d) - f(p[0], p[1] - d)) / (2 * d);
      sum += .5 * std::pow(std::hypot(fx, fy) - 1, 2) * .02 * .02;
    }
    return sum;
  };
  const double variation = (energy(1e-4) - energy(-1e-4)) / 2e-4;
  const DenseLevelSet<2> f(grid, sampled(grid, value), whole);
  const std::vector<float> rate = f.rate({nullptr, 0, 1});
  double along = 0;
  const Points<3> p = grid.centers<3>();
  for (Index i = 0; i < grid.voxels(); ++i) along -= static_cast<double>(rate[i]) * eta(p.col(i)) * .02 * .02;
  EXPECT_NEAR(variation, .548, 1e-3);
  EXPECT_NEAR(along, variation, 1e-3);  // of the squared spacing
}

TEST(DenseLevelSet, TendsToADistanceUnderThePenalty) {
  const Grid grid = cube_grid<2>(41);
  for (const double slope : {.6, 2.0}) {
    DenseLevelSet<2> f(grid, sampled(grid, [slope](const Point<3>& p) { return slope * (.5 - p.head<2>().norm()); }),
                       whole);
    advance(f, .3, 0, {nullptr, 0, 1});
    const auto value = [&](Index x) { return static_cast<double>(f.values()[grid.index(x, 20)]); };
    EXPECT_NEAR((value(29) - value(31)) / (2 * grid.spacing[0]), 1, .1) << slope;  // at a distance of .5
  }
}

TEST(DenseLevelSet, DoesNotDependOnTheNumberOfThreads) {
  const Grid grid = cube_grid<3>(41);
  const auto run = [&](int threads) {
    set_thread_count(threads);
    DenseLevelSet<3> f(grid, sampled(grid, ball<3>(.5)), .3);
    advance(f, .1, 1, {nullptr, .1, .02}, 3);
    set_thread_count(0);
    return f.values();
  };
  EXPECT_EQ(run(1), run(3));
}

TEST(DenseLevelSet, RefusesWhatDoesNotFit) {
  const Grid grid = cube_grid<2>(11);
  EXPECT_NE(
      invalid_input_message([&] { DenseLevelSet<2>(grid, std::vector<float>(5), 1); }).find("number of values = 5"),
      std::string::npos);
  EXPECT_NE(invalid_input_message([&] { DenseLevelSet<2>(grid, std::vector<float>(121), 0); }).find("band = 0"),
            std::string::npos);
  EXPECT_NE(invalid_input_message([&] {
              DenseLevelSet<2>(cube_grid<3>(4), std::vector<float>(64), 1);
            }).find("dimension of the image = 3"),
            std::string::npos);
}

}  // namespace
}  // namespace csrbf::dense_level_set_test
