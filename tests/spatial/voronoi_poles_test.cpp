#include "csrbf/spatial/voronoi_poles.hpp"

#include "core/error_testing.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "spatial/spatial_testing.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace csrbf::voronoi_poles_test {
namespace {

using std::numbers::pi;

// Sites of a common sphere are moved by about 1e-12 so that no two cells share a corner; a corner then moves by that
// over the squared distance of neighbouring sites.
constexpr double joggle = 1e-4;

Points<3> on_sphere(Index n) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Points<3> points = Points<3>::NullaryExpr(3, n, [&] { return normal(random); });
  points.colwise().normalize();
  return points;
}

// Torus of radii 2 and 0.5, evenly in its area.
Points<3> on_torus(Index n) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  Points<3> points(3, n);
  for (Index i = 0; i < n;) {
    const double u = 2 * pi * unit(random), v = 2 * pi * unit(random), rho = 2 + 0.5 * std::cos(v);
    if (2.5 * unit(random) > rho) continue;
    points.col(i++) << rho * std::cos(u), rho * std::sin(u), 0.5 * std::sin(v);
  }
  return points;
}

Points<3> spread(const Points<3>& points, Index n) {
  return points(Eigen::all, farthest_points<3>(points, n).indices);
}

TEST(VoronoiPoles, OfASphereAreAtItsCentre) {
  const Points<3> points = spread(on_sphere(4000), 400);
  const VoronoiPoles<3> poles = voronoi_poles<3>(points);
  EXPECT_LT(poles.negative.colwise().norm().maxCoeff(), joggle);
  EXPECT_LT((medial_axis_distances<3>(points, poles).array() - 1).abs().maxCoeff(), joggle);
}

TEST(VoronoiPoles, OfACircleAreAtItsCentre) {
  Points<2> points(2, 50);
  for (Index i = 0; i < 50; ++i)
    points.col(i) << std::cos(2 * pi * static_cast<double>(i) / 50), std::sin(2 * pi * static_cast<double>(i) / 50);
  EXPECT_LT((medial_axis_distances<2>(points, voronoi_poles<2>(points)).array() - 1).abs().maxCoeff(), joggle);
}

TEST(VoronoiPoles, OfATorusApproachItsMedialCircle) {
  const Points<3> points = spread(on_torus(10000), 500);
  const Eigen::VectorXd distances = medial_axis_distances<3>(points, voronoi_poles<3>(points));
  EXPECT_GT(distances.minCoeff(), 0.499);
  EXPECT_LT(distances.maxCoeff(), 0.51);
}

TEST(VoronoiPoles, AreCentresOfBallsThatHoldNoPoint) {
  const Points<3> points = uniform_points<3>(300, 3);
  const VoronoiPoles<3> poles = voronoi_poles<3>(points);
  for (const Points<3>* set : {&poles.positive, &poles.negative}) {
    for (Index i = 0; i < points.cols(); ++i) {
      if (!set->col(i).allFinite()) continue;
      const Point<3> pole = set->col(i);
      const double nearest = (points.colwise() - pole).colwise().norm().minCoeff();
      const double own = (points.col(i) - pole).norm();
      EXPECT_LT(own - nearest, joggle * own);
    }
  }
}

TEST(VoronoiPoles, LieOnOppositeSidesOfTheirPoint) {
  const Points<3> points = spread(on_torus(10000), 300);
  const VoronoiPoles<3> poles = voronoi_poles<3>(points);
  for (Index i = 0; i < points.cols(); ++i) {
    const Point<3> p = points.col(i), outwards = poles.positive.col(i) - p, inwards = poles.negative.col(i) - p;
    EXPECT_LT(outwards.dot(inwards), 0);
    EXPECT_GE(outwards.norm(), inwards.norm());
  }
}

TEST(VoronoiPoles, BoundTheDistanceToTheMedialAxisByTheOwnPoles) {
  const Points<3> points = spread(on_torus(10000), 100);
  const VoronoiPoles<3> poles = voronoi_poles<3>(points);
  const Eigen::VectorXd own = (points - poles.negative).colwise().norm();
  const Eigen::VectorXd distances = medial_axis_distances<3>(points, poles);
  EXPECT_TRUE((distances.array() <= own.array()).all());
  EXPECT_GE(distances.minCoeff(), (1 - joggle) * own.minCoeff());
  // With few points own poles are far from the axis (Fig. 6.10): the nearest one is not.
  EXPECT_GT(own.maxCoeff(), 1.5 * distances.maxCoeff());
}

TEST(VoronoiPoles, MoveAndScaleWithThePoints) {
  const Points<3> points = spread(on_torus(10000), 300);
  const Points<3> moved = (1e-3 * points).colwise() + Point<3>(5, -7, 3);
  const Eigen::VectorXd before = medial_axis_distances<3>(points, voronoi_poles<3>(points));
  const Eigen::VectorXd after = medial_axis_distances<3>(moved, voronoi_poles<3>(moved));
  EXPECT_LT((1000 * after - before).cwiseAbs().maxCoeff(), joggle);
}

TEST(VoronoiPoles, OfPlanesGridsAndSinglePointsComeOut) {
  Points<3> grid(3, 100), cube(3, 125);
  for (Index i = 0; i < 100; ++i) grid.col(i) << static_cast<double>(i % 10), static_cast<double>(i / 10), 0;
  for (Index i = 0; i < 125; ++i)
    cube.col(i) << static_cast<double>(i % 5), static_cast<double>(i / 5 % 5), static_cast<double>(i / 25);
  // Nothing but the cut-off sites bounds the cells of a plane.
  EXPECT_GT(medial_axis_distances<3>(grid, voronoi_poles<3>(grid)).minCoeff(), 9);
  EXPECT_LT(medial_axis_distances<3>(cube, voronoi_poles<3>(cube)).maxCoeff(), 2);
  const Points<3> one = Points<3>::Zero(3, 1);
  EXPECT_TRUE(std::isinf(medial_axis_distances<3>(one, voronoi_poles<3>(one))[0]));
  EXPECT_EQ(voronoi_poles<3>(Points<3>(3, 0)).negative.cols(), 0);
}

TEST(VoronoiPoles, RefusePointsThatAreNotFinite) {
  Points<3> points = uniform_points<3>(10, 1);
  points(1, 4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(invalid_input_message([&] { (void)voronoi_poles<3>(points); }).find("voronoi_poles: points = NaN"),
            std::string::npos);
}

}  // namespace
}  // namespace csrbf::voronoi_poles_test
