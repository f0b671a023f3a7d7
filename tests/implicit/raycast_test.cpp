#include "csrbf/implicit/raycast.hpp"

#include "core/error_testing.hpp"
#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/combine.hpp"
#include "implicit/analytic_fields.hpp"
#include "implicit/ray_oracle.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace csrbf::raycast_test {
namespace {

constexpr double exact = 1e-12;  // rounding of positions of order one

const Point<3> center(0.013, -0.021, 0.034);

// Where a ray first meets the sphere of radius R around c.
double sphere_hit(const Point<3>& o, const Point<3>& d, double R, const Point<3>& c = center) {
  const double b = (o - c).dot(d), root = b * b - (o - c).squaredNorm() + R * R;
  if (root < 0) return std::numeric_limits<double>::infinity();
  for (const double t : {-b - std::sqrt(root), -b + std::sqrt(root)})
    if (t >= 0) return t;
  return std::numeric_limits<double>::infinity();
}

TEST(Raycast, MeetsASphereWhereAlgebraSaysSo) {
  const Rays rays = random_rays(box_around(center, Point<3>::Ones()), 2000, 1);
  const AnalyticField plain = ball(1, center);
  const EnclosedBall enclosed(1, center);
  for (const Field<3>* field : {static_cast<const Field<3>*>(&plain), static_cast<const Field<3>*>(&enclosed)}) {
    const RayHits hits = raycast(*field, rays.origins, rays.directions, {.resolution = 32});
    EXPECT_EQ(hits.guaranteed, field == &enclosed);
    int met = 0;
    for (Index i = 0; i < rays.size(); ++i) {
      const double t = sphere_hit(rays.origins.col(i), rays.directions.col(i), 1);
      if (std::isinf(t)) {
        EXPECT_TRUE(std::isinf(hits.t[i]));
        EXPECT_TRUE(hits.normals.col(i).array().isNaN().all());
        continue;
      }
      ++met;
      const Point<3> p = rays.origins.col(i) + t * rays.directions.col(i) - center;
      // A ray that grazes the sphere meets it where rounding says.
      EXPECT_NEAR(hits.t[i], t, exact / std::abs(p.dot(rays.directions.col(i))));
      EXPECT_LE((hits.normals.col(i) - p).norm(), 1e-9);
    }
    EXPECT_GT(met, 500);
  }
}

TEST(Raycast, StartsAtTheOriginAndMeetsSurfacesFromInside) {
  const EnclosedBall field(1, center);
  const Points<3> d = random_directions(300, 2);
  const RayHits from_center = raycast(field, center.replicate(1, 300), d, {.resolution = 16});
  EXPECT_LE((from_center.t.array() - 1).abs().maxCoeff(), exact);
  EXPECT_LE((from_center.normals - d).cwiseAbs().maxCoeff(), exact);
  const RayHits away = raycast(field, (1.5 * d).colwise() + center, d, {.resolution = 16});
  EXPECT_TRUE(away.t.array().isInf().all());
}

TEST(Raycast, TakesDirectionsOfAnyLengthAndOriginsFarAway) {
  const EnclosedBall field(1, center);
  const Points<3> d = random_directions(200, 3);
  const RayHits hits = raycast(field, (-1e6 * d).colwise() + center, 1e-150 * d, {.resolution = 16});
  EXPECT_LE((hits.t.array() - (1e6 - 1)).abs().maxCoeff(), 1e-9);  // rounding of numbers of 1e6
}

TEST(Raycast, TellsRaysThatGrazeFromRaysThatMiss) {
  const AnalyticField plain = ball(1, center);
  const EnclosedBall enclosed(1, center);
  const Points<3> d = random_directions(300, 4);
  for (const Field<3>* field : {static_cast<const Field<3>*>(&plain), static_cast<const Field<3>*>(&enclosed)})
    for (const double off : {-1e-3, -1e-6, -1e-9, 1e-9, 1e-6, 1e-3}) {
      Points<3> origins(3, 300);
      for (Index i = 0; i < 300; ++i) origins.col(i) = center + (1 + off) * d.col(i).unitOrthogonal() - 3 * d.col(i);
      const RayHits hits = raycast(*field, origins, d, {.resolution = 24});
      for (Index i = 0; i < 300; ++i) EXPECT_EQ(std::isinf(hits.t[i]), off > 0) << off;
    }
}

TEST(Raycast, FindsPartsMuchThinnerThanACellWhenBoundsAreKnown) {
  const auto outer = std::make_shared<const EnclosedBall>(1, center);
  const auto inner = std::make_shared<const EnclosedBall>(1 - 1e-4, center);
  const auto speck = std::make_shared<const EnclosedBall>(1e-5, Point<3>(center + Point<3>(0, 0, 1.01)));
  const Solid shell = (outer - inner) | speck;
  const Points<3> d = random_directions(300, 5);
  const RayHits from_center = raycast(*shell, center.replicate(1, 300), d, {.resolution = 16});
  EXPECT_TRUE(from_center.guaranteed);
  EXPECT_LE((from_center.t.array() - (1 - 1e-4)).abs().maxCoeff(), exact);
  const RayHits from_outside = raycast(*shell, (-4 * d).colwise() + center, d, {.resolution = 16});
  EXPECT_LE((from_outside.t.array() - 3).abs().maxCoeff(), exact);
  const RayHits at_speck = raycast(*shell, center + Point<3>(0, 0, 5), Point<3>(0, 0, -1), {.resolution = 16});
  EXPECT_NEAR(at_speck.t[0], 5 - 1.01 - 1e-5, exact);
}

TEST(Raycast, AgreesWithDenseSamplingOnSolidsOfAllKinds) {
  const auto a = std::make_shared<const EnclosedBall>(1, Point<3>(-0.6, 0, 0));
  const auto b = std::make_shared<const EnclosedBall>(0.9, Point<3>(0.7, 0.1, 0));
  const auto plain_a = std::make_shared<const AnalyticField>(ball(1, {-0.6, 0, 0}));
  const auto plain_b = std::make_shared<const AnalyticField>(ball(0.9, {0.7, 0.1, 0}));
  for (const Blending blending :
       {Blending::sharp, Blending::r_function, Blending::super_elliptic, Blending::log_sum_exp})
    for (const Operation operation : {Operation::unite, Operation::intersect, Operation::subtract}) {
      CombineOptions options;
      options.blending = blending;
      const Solid known = combine(operation, {a, b}, options),
                  sampled = combine(operation, {plain_a, plain_b}, options);
      for (const Solid& solid : {known, sampled}) {
        const Rays rays = random_rays(solid->bounds(), 60, 6);
        const RayHits hits = raycast(*solid, rays.origins, rays.directions, {.resolution = 24});
        EXPECT_EQ(hits.guaranteed, solid == known);
        EXPECT_EQ(disagreements(*solid, rays, hits.t, 500), 0) << name_of(blending) << " " << name_of(operation);
      }
    }
}

TEST(Raycast, AgreesWithDenseSamplingOnATorus) {
  const AnalyticField torus = distance_torus(1, 0.3);
  const Rays rays = random_rays(torus.bounds(), 300, 7);
  const RayHits hits = raycast(torus, rays.origins, rays.directions, {.resolution = 48});
  EXPECT_EQ(disagreements(torus, rays, hits.t, 500), 0);
}

TEST(Raycast, AgreesWithDenseSamplingOnExpansions) {
  // 1 - |p|^2 and bumps.
  const Points<3> centers = random_points_in(box_around(Point<3>::Zero(), Point<3>::Ones()), 80, 9);
  PolynomialTail<3> tail;
  tail.degree = 2;
  tail.coefficients = Eigen::VectorXd::Zero(10);
  for (const Index square : {4, 7, 9}) tail.coefficients[square] = -1;
  tail.coefficients[0] = 1;
  const Eigen::VectorXd alpha = 0.5 * random_directions(80, 10).row(0).transpose();
  const auto field =
      make_expansion<3>(Kernel("wendland-c2", 3), centers, Eigen::VectorXd::Constant(1, 0.4), alpha, tail);
  const Rays rays = random_rays(field->bounds(), 300, 11);
  const RayHits hits = raycast(*field, rays.origins, rays.directions, {.resolution = 24});
  EXPECT_TRUE(hits.guaranteed);
  EXPECT_EQ(disagreements(*field, rays, hits.t, 2000), 0);
}

TEST(Raycast, FindsSheetsThinnerThanACellOfFieldsWithoutBounds) {
  // A ball that thins out into a disc, half a cell thick, which a polygonization sees only here and there.
  const double cell = 2.6 / 32;
  const AnalyticField field(
      [=](const AnalyticField::Variables& x) {
        const auto z = x[2] - center[2] - 0.4 * cell - 0.05 * x[0];
        const auto off_axis = (x[0] - center[0]) * (x[0] - center[0]) + (x[1] - center[1]) * (x[1] - center[1]);
        const auto bulge = 4.0 * smooth_step((0.09 - off_axis) * (1 / 0.09));
        return (0.06 + bulge) * cell - (1 / cell) * z * z - 0.5 * smooth_step(5.0 * off_axis - 4.0);
      },
      box_around(center, Point<3>::Constant(1.3)));
  const Rays rays = random_rays(box_around(center, Point<3>(1, 1, 0.1)), 400, 12);
  const RayHits hits = raycast(field, rays.origins, rays.directions, {.resolution = 32});
  EXPECT_FALSE(hits.guaranteed);
  EXPECT_EQ(disagreements(field, rays, hits.t, 4000), 0);
}

TEST(Raycast, NoticesBoundsThatAreTooSmall) {
  // A shell three cells thick, with a spike of f in its middle, which no vertex of a polygonization sees.
  const double cell = 2.6 / 32;
  const AnalyticField field(
      [=](const AnalyticField::Variables& x) {
        const auto square = (x[0] - center[0]) * (x[0] - center[0]) + (x[1] - center[1]) * (x[1] - center[1]) +
                            (x[2] - center[2]) * (x[2] - center[2]);
        const auto off = (1 / cell) * (square_root(square + 1e-4) - 0.9);
        return cell * (2.25 - off * off) + 8 * cell * smooth_step(2.0 - 8.0 * (off * off));
      },
      box_around(center, Point<3>::Constant(1.3)));
  const Rays rays = random_rays(box_around(center, Point<3>::Ones()), 500, 13);
  const RayHits hits = raycast(field, rays.origins, rays.directions, {.resolution = 32});
  EXPECT_EQ(disagreements(field, rays, hits.t, 4000), 0);
}

TEST(Raycast, GetsOnAlongTheWallsOfCells) {
  const AnalyticField plain = ball(1);
  const EnclosedBall enclosed(1);
  // Walls are at multiples of 1/8.
  std::vector<Point<3>> starts;
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j)
      if (i * i + j * j != 64) starts.emplace_back(i / 8.0, j / 8.0, 2);  // those graze the ball
  Points<3> origins(3, static_cast<Index>(starts.size()));
  for (std::size_t i = 0; i < starts.size(); ++i) origins.col(static_cast<Index>(i)) = starts[i];
  for (const Field<3>* field : {static_cast<const Field<3>*>(&plain), static_cast<const Field<3>*>(&enclosed)})
    for (const double tiny : {0.0, 1e-300, -1e-300, 1e-17, -1e-17}) {
      const Point<3> along(tiny, -tiny, -1);
      const RayHits hits = raycast(*field, origins, along.replicate(1, origins.cols()), {.resolution = 20});
      for (Index i = 0; i < origins.cols(); ++i) {
        const double expected = sphere_hit(origins.col(i), along, 1, Point<3>::Zero());
        EXPECT_EQ(std::isinf(hits.t[i]), std::isinf(expected));
        if (std::isinf(expected)) continue;
        EXPECT_NEAR(hits.t[i], expected, 1e-11);
      }
    }
}

TEST(Raycast, EndsAtTheLargestDistance) {
  const EnclosedBall field(1, center);
  const Point<3> origin = center + Point<3>(0, 0, 3), down(0, 0, -1);
  EXPECT_TRUE(std::isinf(raycast(field, origin, down, {.resolution = 16, .t_max = 2 - 1e-6}).t[0]));
  EXPECT_NEAR(raycast(field, origin, down, {.resolution = 16, .t_max = 2 + 1e-6}).t[0], 2, exact);
}

TEST(Raycast, DoesNotDependOnThreadsOrNeighbours) {
  const AnalyticField torus = distance_torus(1, 0.3);
  const Rays rays = random_rays(torus.bounds(), 1500, 8);
  set_thread_count(1);
  const RayHits one = raycast(torus, rays.origins, rays.directions, {.resolution = 32});
  set_thread_count(0);
  const RayHits all = raycast(torus, rays.origins, rays.directions, {.resolution = 32});
  EXPECT_EQ(one.t, all.t);
  const RayHits last = raycast(torus, rays.origins.rightCols(3), rays.directions.rightCols(3), {.resolution = 32});
  EXPECT_EQ(last.t, one.t.tail(3));
}

TEST(Raycast, OfAFieldWithoutSurfaceMeetsNothing) {
  const AnalyticField empty([](const AnalyticField::Variables& x) { return x[0] * x[0] + 1.0; },
                            box_around(center, Point<3>::Ones()));
  EXPECT_TRUE(std::isinf(raycast(empty, center, Point<3>(1, 0, 0), {.resolution = 16}).t[0]));
  EXPECT_EQ(raycast(empty, Points<3>(3, 0), Points<3>(3, 0), {.resolution = 16}).t.size(), 0);
}

TEST(Raycast, RefusesInvalidRaysAndOptions) {
  const AnalyticField field = ball(1);
  const Point<3> o(0, 0, 3), d(0, 0, -1);
  const auto message = [&](const Points<3>& origins, const Points<3>& directions, const RaycastOptions& options = {}) {
    return invalid_input_message([&] { raycast(field, origins, directions, options); });
  };
  EXPECT_NE(message(o, Points<3>(3, 0)).find("number of directions = 0"), std::string::npos);
  EXPECT_NE(message(Point<3>(0, NAN, 0), d).find("origins = NaN"), std::string::npos);
  EXPECT_NE(message(o, Point<3>(0, INFINITY, 0)).find("directions = NaN"), std::string::npos);
  EXPECT_NE(message(o, Point<3>(0, 0, 0)).find("length of a direction = 0"), std::string::npos);
  EXPECT_NE(message(o, d, {.resolution = 3}).find("resolution = 3"), std::string::npos);
  EXPECT_NE(message(o, d, {.t_max = 0}).find("t_max = 0"), std::string::npos);
  EXPECT_THROW(raycast(field, o, d, {.resolution = 8, .progress = [](std::string_view, double) { return false; }}),
               Cancelled);
}

}  // namespace
}  // namespace csrbf::raycast_test
