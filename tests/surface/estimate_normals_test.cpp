#include "csrbf/surface/estimate_normals.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/io/points.hpp"
#include "surface/oriented_shapes.hpp"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <string>

namespace csrbf::estimate_normals_test {
namespace {

constexpr double rounding = 1e-9;

Points<3> lines_of(const Points<3>& points, Index neighbors = 0) {
  return estimate_normals(points, {.neighbors = neighbors, .orient = Orient::none});
}

TEST(EstimateNormals, AreExactOnAPlane) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Point<3> normal = Point<3>(1, 2, -2) / 3, first = Point<3>(2, 1, 2) / 3, second = Point<3>(2, -2, -1) / 3;
  Points<3> points(3, 500);
  for (Index i = 0; i < 500; ++i)
    points.col(i) = Point<3>(4, 5, 6) + uniform(random) * first + uniform(random) * second;
  const Points<3> truth = normal.replicate(1, 500);
  EXPECT_LT((lines_of(points).colwise().norm().array() - 1).abs().maxCoeff(), rounding);
  EXPECT_LT(angle_error(lines_of(points), truth), 1e-6);
  EXPECT_LT(angle_error(lines_of(points, 100), truth), 1e-6);  // neighbourhoods shared by several points
}

TEST(EstimateNormals, OfThreePointsAreNormalToTheirTriangle) {
  const Points<3> points = (Points<3>(3, 3) << 0, 1, 0, 0, 0, 1, 5, 5, 5).finished();
  const Points<3> normals = estimate_normals(points);
  EXPECT_LT(angle_error(normals, Point<3>(0, 0, 1).replicate(1, 3)), 1e-6);
  EXPECT_GT(normals.row(2).minCoeff(), 0);  // an open sheet looks to +z
}

TEST(EstimateNormals, OfASphereAreRadialAndOutward) {
  NormalReport report;
  const Shape sphere = random_sphere(5000, 2, {1, 2, 3}, 4);
  const Points<3> normals = estimate_normals(sphere.points, {}, &report);
  EXPECT_EQ(outward_share(normals, sphere.normals), 1);
  EXPECT_LT(angle_error(normals, sphere.normals), 0.3);  // the ridge leaves 1 % of the curvature term of some degrees
  EXPECT_EQ(report.neighbors, 16);
  EXPECT_EQ(report.undetermined, 0);
}

TEST(EstimateNormals, AgreeWithPrincipalAxesFoundByBruteForce) {
  // Without curvature the quadric changes nothing: compare with the plain eigenvector on planes with 5 % of noise.
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  Points<3> points(3, 300);
  for (Index i = 0; i < 300; ++i) points.col(i) << uniform(random), uniform(random), 0.05 * normal(random);
  constexpr Index neighbors = 30;
  const Points<3> normals = lines_of(points, neighbors);
  Points<3> axes(3, 300);
  for (Index i = 0; i < 300; ++i) {
    std::vector<std::pair<double, Index>> near;
    for (Index j = 0; j < 300; ++j) near.emplace_back((points.col(j) - points.col(i)).squaredNorm(), j);
    std::sort(near.begin(), near.end());
    Points<3> chosen(3, neighbors);
    for (Index j = 0; j < neighbors; ++j) chosen.col(j) = points.col(near[j].second);
    chosen = (chosen.colwise() - chosen.rowwise().mean()).eval();
    axes.col(i) = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(chosen * chosen.transpose()).eigenvectors().col(0);
  }
  // The plane of 30 samples is known to noise / (half width * sqrt(30)), 3 degrees; the quadric has twice as many
  // unknowns and neighbours on one side only along the rim.
  EXPECT_LT(angle_error(normals, Point<3>(0, 0, 1).replicate(1, 300)), 12);
  EXPECT_LT(angle_error(normals, axes), 12);
}

double median_angle(const Points<3>& normals, const Points<3>& truth) {
  std::vector<double> angle;
  for (Index i = 0; i < truth.cols(); ++i) angle.push_back(angle_error(normals.col(i), truth.col(i)));
  std::nth_element(angle.begin(), angle.begin() + truth.cols() / 2, angle.end());
  return angle[angle.size() / 2];
}

TEST(EstimateNormals, ErrorOnATorusIsOfSecondOrderInTheSpacing) {
  // A quadric over a neighbourhood of radius r leaves the third order of the height: r^2 in the normal.
  double before = 0;
  for (const Index n : {4000, 16000, 64000}) {
    const Shape torus = random_torus(n, 4);
    const double error = median_angle(lines_of(torus.points), torus.normals);
    if (before > 0) {
      EXPECT_GT(std::log2(before / error), 2 - 0.35) << n;
    }
    before = error;
  }
}

TEST(EstimateNormals, TakeMoreNeighborsUnderNoise) {
  // 0.5 % of the diagonal is 0.7 spacings: 16 neighbours alone would be off by 30 degrees.
  const double diagonal = std::hypot(2 * (torus_major + torus_minor), 2 * (torus_major + torus_minor), 2 * torus_minor);
  const Shape torus = random_torus(20000, 5, 0.005 * diagonal);
  NormalReport report;
  const Points<3> normals = estimate_normals(torus.points, {}, &report);
  EXPECT_GE(report.neighbors, 96);
  EXPECT_EQ(outward_share(normals, torus.normals), 1);
  Points<3> at_noisy_place = torus.normals;
  for (Index i = 0; i < torus.size(); ++i) {
    const Point<3> p = torus.points.col(i);
    at_noisy_place.col(i) = (p - torus_major * Point<3>(p[0], p[1], 0).normalized()).normalized();
  }
  EXPECT_LT(angle_error(normals, at_noisy_place), 4);
  EXPECT_GT(angle_error(lines_of(torus.points, 16), at_noisy_place), 20);
}

TEST(EstimateNormals, PointOutwardInNoiseWiderThanTheSpacing) {
  const Shape torus = random_torus(10'000, 6, 0.048);  // 1.3 spacings
  const Points<3> normals = estimate_normals(torus.points);
  EXPECT_GT(outward_share(normals, torus.normals), 0.999);
  EXPECT_LT(median_angle(normals, torus.normals), 10);  // degrees
}

TEST(EstimateNormals, OnABoxAreExactAwayFromItsEdges) {
  const Shape box = random_box({1, 1, 1}, 0.03, 6);
  const Points<3> normals = estimate_normals(box.points);
  EXPECT_GT(outward_share(normals, box.normals), 0.9999);
  Index inner = 0;
  for (Index i = 0; i < box.size(); ++i) {
    const Point<3> p = box.points.col(i).cwiseAbs();
    if ((p.array() > 0.85).count() > 1) continue;
    ++inner;
    EXPECT_GT(normals.col(i).dot(box.normals.col(i)), 1 - rounding);
  }
  EXPECT_GT(inner, box.size() / 2);
}

TEST(EstimateNormals, LookAtTheViewpoint) {
  const Shape sphere = random_sphere(2000, 7);
  const Point<3> eye(5, 1, 0);
  const Points<3> normals = estimate_normals(sphere.points, {.orient = Orient::viewpoint, .viewpoint = eye});
  for (Index i = 0; i < sphere.size(); ++i) EXPECT_GT(normals.col(i).dot(eye - sphere.points.col(i)), 0);
}

// The winding number alone leaves the inner body turned in part.
TEST(EstimateNormals, PointOutOfABodyInsideACavity) {
  constexpr double spacing = 0.0485;
  Shape cavity = random_box(Point<3>::Constant(0.85), spacing, 42);
  cavity.normals = -cavity.normals;
  const Shape hollow = join(random_box(Point<3>::Constant(1), spacing, 41), cavity);
  const Shape nested = join(hollow, random_box(Point<3>::Constant(0.5), spacing, 43));
  EXPECT_GT(outward_share(estimate_normals(nested.points), nested.normals), 0.995);
}

// Two spacings apart, the sheets of shells are told from each other in places, and by the winding number in others.
TEST(EstimateNormals, OfShellsWithinShellsPointOutOfTheirWalls) {
  Shape shells = random_sphere(2880, 51, Point<3>::Zero(), 0.98);
  for (const double radius : {0.88, 0.71, 0.59, 0.3}) {
    const auto count = static_cast<Index>(3000 * radius * radius);
    Shape shell = random_sphere(count, 52 + static_cast<unsigned>(count), Point<3>::Zero(), radius);
    if (radius == 0.88 || radius == 0.59) shell.normals *= -1;  // cavities
    shells = join(shells, shell);
  }
  EXPECT_GT(outward_share(estimate_normals(shells.points), shells.normals), 0.99);
}

// A rough sheet is no thin solid, though the sides of two sheets can be told apart in its noise.
TEST(EstimateNormals, OfANoisySheetAgree) {
  std::mt19937_64 random(50);
  std::uniform_real_distribution<double> uniform(0, 1);
  constexpr Index count = 3000;
  std::normal_distribution<double> noise(0, 0.8 / std::sqrt(static_cast<double>(count)));  // spacings
  Points<3> points(3, count);
  for (Index i = 0; i < count; ++i)
    points.col(i) << uniform(random) + noise(random), uniform(random) + noise(random), noise(random);
  EXPECT_GT(outward_share(estimate_normals(points), Point<3>(0, 0, 1).replicate(1, count)), 0.98);
}

// Signs by neighbours enclose the filled bowl, nearly a solid.
TEST(EstimateNormals, OfAWallPointAwayFromBothItsSides) {
  const Shape bowl = random_bowl(10'000, 0.9, 3);
  EXPECT_GT(outward_share(estimate_normals(bowl.points), bowl.normals), 0.95);
}

// The density falls by a factor of 400 along x.
// Neighbourhoods wide enough to average the noise reach the other sheet.
TEST(EstimateNormals, OfNoisyBarsPointOutward) {
  constexpr double spacing = 0.01;
  Shape bars;
  for (const unsigned k : {0U, 1U, 2U, 3U}) {
    Shape bar = random_box({0.5, 5 * spacing, 3 * spacing}, spacing, k);
    bar.points.row(1).array() += 15 * spacing * k;
    bars = k == 0 ? bar : join(bars, bar);
  }
  std::mt19937_64 random(8);
  std::normal_distribution<double> noise(0, 0.6 * spacing);
  for (double& coordinate : bars.points.reshaped()) coordinate += noise(random);
  NormalReport report;
  (void)estimate_normals(bars.points, {.orient = Orient::none}, &report);
  EXPECT_LT(report.neighbors, 100);
  EXPECT_GT(outward_share(estimate_normals(bars.points), bars.normals), 0.99);
}

TEST(EstimateNormals, PointIntoChambersInNoise) {
  constexpr double spacing = 0.035, wall = 2 * spacing;
  Shape box = random_box({1, 0.7, 0.5}, spacing, 1);
  for (const double x : {-0.4, 0.5}) {
    Shape chamber = random_box({x < 0 ? 0.5 - wall : 0.4 - wall, 0.7 - wall, 0.5 - wall}, spacing, x < 0 ? 2 : 3);
    chamber.points.row(0).array() += x;
    chamber.normals *= -1;
    box = join(box, chamber);
  }
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise(0, 0.2 * spacing);
  for (double& coordinate : box.points.reshaped()) coordinate += noise(random);
  EXPECT_GT(outward_share(estimate_normals(box.points), box.normals), 0.9);
}

TEST(EstimateNormals, PointOutwardWherePointsAreFarBetween) {
  const Shape dense = random_torus(60'000, 48);
  std::mt19937_64 random(47);
  std::uniform_real_distribution<double> uniform;
  const double reach = torus_major + torus_minor;
  std::vector<Index> kept;
  for (Index i = 0; i < dense.size(); ++i)
    if (uniform(random) < std::exp(-3 * (1 + dense.points(0, i) / reach))) kept.push_back(i);
  const Shape fading{dense.points(Eigen::all, kept), dense.normals(Eigen::all, kept), dense.area};
  EXPECT_EQ(outward_share(estimate_normals(fading.points), fading.normals), 1);
}

// One by one, hills and hollows are nearly solids.
TEST(EstimateNormals, OfHillsPointUp) {
  for (const double height : {0.05, 0.1, 0.15})
    for (const double noise : {0.0, 0.4}) {
      const Shape hills = random_hills(5000, height, 46, noise / std::sqrt(5000));
      const Points<3> normals = estimate_normals(hills.points);
      EXPECT_EQ(outward_share(normals, hills.normals), 1) << height << ", noise " << noise;
    }
}

// Walls and roofs enclose a solid nearly as well if the roof is turned.
TEST(EstimateNormals, OfABlockOfHousesPointOutOfThem) {
  const Shape block = random_block(10'000, 47);
  EXPECT_GT(outward_share(estimate_normals(block.points), block.normals), 0.999);
}

// The ball encloses a solid whichever side of the ground is up.
TEST(EstimateNormals, OfTheGroundPointToTheSideOfWhatStandsOnIt) {
  const Shape ball = random_ball_on_ground(10'000, 48);
  EXPECT_GT(outward_share(estimate_normals(ball.points), ball.normals), 0.99);
}

// Two sheets 1.3 spacings apart, on the half that is seen twice, are no plate.
TEST(EstimateNormals, PointOutOfASolidSeenTwiceByScansThatDoNotFit) {
  const Shape whole = random_torus(6000, 44), again = random_torus(6000, 45);
  std::vector<Index> half;
  for (Index i = 0; i < again.size(); ++i)
    if (again.points(0, i) < 0) half.push_back(i);
  Shape second{again.points(Eigen::all, half), again.normals(Eigen::all, half), 0.5 * again.area};
  second.points.row(2).array() += 1.3 * whole.spacing();
  const Shape both = join(whole, second);
  EXPECT_GT(outward_share(estimate_normals(both.points), both.normals), 0.99);
}

TEST(EstimateNormals, AreInvariantUnderSimilarities) {
  const Shape torus = random_torus(3000, 8);
  const Points<3> normals = estimate_normals(torus.points);
  for (const double scale : {1e-30, 1.0, 1e30}) {
    const Points<3> moved = (scale * some_rotation() * torus.points).colwise() + scale * Point<3>(3, -4, 5);
    const Points<3> turned = estimate_normals(moved);
    EXPECT_LT((some_rotation().transpose() * turned - normals).cwiseAbs().maxCoeff(), 1e-7)
        << scale;  // closed-form axes
  }
}

TEST(EstimateNormals, DoNotDependOnTheNumberOfThreads) {
  const Shape torus = random_torus(3000, 9, 0.02);
  for (const Index neighbors : {0, 16, 100}) {
    set_thread_count(1);
    const Points<3> normals = estimate_normals(torus.points, {.neighbors = neighbors});
    for (const int threads : {2, 5}) {
      set_thread_count(threads);
      EXPECT_EQ(estimate_normals(torus.points, {.neighbors = neighbors}), normals);
    }
  }
  set_thread_count(0);
}

TEST(EstimateNormals, OfCoincidingPointsAreEqual) {
  const Shape sphere = random_sphere(1000, 10);
  Points<3> points(3, 3100);
  points << sphere.points, sphere.points, sphere.points, sphere.points.col(7).replicate(1, 100);
  NormalReport report;
  const Points<3> normals = estimate_normals(points, {}, &report);
  EXPECT_EQ(report.duplicates, 2100);
  EXPECT_EQ(normals.leftCols(1000), estimate_normals(sphere.points));
  EXPECT_EQ(normals.middleCols(1000, 1000), normals.leftCols(1000));
  EXPECT_EQ(normals.rightCols(100), normals.col(7).replicate(1, 100));
}

TEST(EstimateNormals, ReachAcrossScanLines) {
  // Lines 20 times further apart than the points on them.
  Points<3> points(3, 40 * 800);
  for (Index line = 0; line < 40; ++line)
    for (Index k = 0; k < 800; ++k)
      points.col(800 * line + k) << static_cast<double>(k), 20.0 * static_cast<double>(line),
          0.1 * static_cast<double>(k);
  NormalReport report;
  const Points<3> normals = estimate_normals(points, {}, &report);
  EXPECT_EQ(report.undetermined, 0);
  EXPECT_LT(angle_error(normals, Point<3>(-0.1, 0, 1).normalized().replicate(1, points.cols())), 1e-4);
}

TEST(EstimateNormals, OfAWireFarFromEverythingAreZero) {
  const Shape sphere = random_sphere(2000, 11);
  Points<3> points(3, 2600);
  points.leftCols(2000) = sphere.points;
  for (Index i = 0; i < 600; ++i) points.col(2000 + i) << 100 + 0.01 * static_cast<double>(i), 0, 0;
  NormalReport report;
  const Points<3> normals = estimate_normals(points, {}, &report);
  EXPECT_EQ(report.undetermined, 600);
  EXPECT_EQ(normals.rightCols(600), Points<3>::Zero(3, 600));
  EXPECT_EQ(outward_share(normals.leftCols(2000), sphere.normals), 1);
}

TEST(EstimateNormals, OfScansAgreeWithTheirScanners) {
  for (const auto& [name, share] :
       {std::pair{"bunny_scans_362k.ply", 0.995}, std::pair{"dragon_stand_scans.ply", 0.99}}) {
    if (!std::filesystem::exists(scan(name))) GTEST_SKIP() << "no scans: " << scan(name);
    const PointCloud cloud = read_points(scan(name).string());
    EXPECT_GT(outward_share(estimate_normals(cloud.points), cloud.normals), share) << name;
  }
}

TEST(EstimateNormals, RejectPointsWithoutASurface) {
  Points<3> points = random_sphere(100, 12).points;
  EXPECT_EQ(invalid_input_message([&] { estimate_normals(points, {.neighbors = 2}); }),
            "estimate_normals: neighbors = 2: must be 0 (automatic) or at least 3");
  points(1, 5) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(invalid_input_message([&] { estimate_normals(points); }),
            "estimate_normals: points = NaN or infinity: must be finite; remove such points");
  EXPECT_EQ(
      invalid_input_message([&] { estimate_normals(Points<3>(3, 0)); }),
      "estimate_normals: number of different points = 0: a surface needs points in 3 dimensions, at least 3 of them");
  EXPECT_EQ(
      invalid_input_message([&] { estimate_normals(Points<3>::Ones(3, 50)); }),
      "estimate_normals: number of different points = 1: a surface needs points in 3 dimensions, at least 3 of them");
  const Points<3> line = Point<3>(1, 2, 3) * Eigen::RowVectorXd::LinSpaced(100, 0, 1);
  EXPECT_EQ(
      invalid_input_message([&] { estimate_normals(line); }),
      "estimate_normals: points = all on one line: a surface needs points that spread in at least two directions");
}

TEST(EstimateNormals, StopWhenTold) {
  const Shape sphere = random_sphere(2000, 13);
  int calls = 0;
  double last = 0;
  estimate_normals(sphere.points, {.progress = [&](std::string_view, double fraction) {
                     EXPECT_GE(fraction, last);
                     last = fraction;
                     ++calls;
                     return true;
                   }});
  EXPECT_EQ(last, 1);
  for (int stop = 1; stop <= calls; ++stop) {
    int call = 0;
    EXPECT_THROW(estimate_normals(sphere.points, {.progress = [&](std::string_view, double) { return ++call < stop; }}),
                 Cancelled);
  }
}

}  // namespace
}  // namespace csrbf::estimate_normals_test
