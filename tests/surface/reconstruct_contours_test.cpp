#include "csrbf/surface/reconstruct_contours.hpp"

#include "csrbf/implicit/polygonize.hpp"
#include "surface/contour_testing.hpp"
#include "surface/surface_testing.hpp"

namespace csrbf::reconstruct_contours_test {
namespace {

constexpr Index few_centers = 700;  // enough for these shapes, and quick
constexpr int cells = 28;           // of the grid that finds the contours
constexpr int resolution = 48;

double sphere(const Point<3>& p) {
  return 1 - p.norm();
}

// Axes 1, 0.7 and 1.4, turned.
double ellipsoid(const Point<3>& p) {
  const Eigen::Matrix3d R = rotation(0.5).R;
  return 1 - (R * p).cwiseQuotient(Point<3>(1, 0.7, 1.4)).norm();
}

// Torus around y: planes z = constant cut it in one or two curves.
double torus(const Point<3>& p) {
  return Torus{}.depth({p.x(), p.z(), p.y()});
}

// A cup: half an ellipsoid with a cavity, open above, tilted by its axis that leans in x.
double cup(const Point<3>& p) {
  const Point<3> q(p.x() - 0.3 * p.z(), p.y(), p.z());
  const auto part = [&](double radius, double depth) {
    return 1 - std::hypot(std::hypot(q.x(), q.y()) / radius, q.z() / depth);
  };
  return std::min(part(0.8, 1.5), -part(0.5, 1.1));
}

// One tube below that becomes two above z = 0.
double branches(const Point<3>& p) {
  const double lean = 0.8 * std::max(0.0, p.z());
  return 0.35 - std::min(std::hypot(p.x() - lean, p.y()), std::hypot(p.x() + lean, p.y()));
}

struct Built {
  Reconstruction surface;
  Mesh mesh;
  double diagonal = 1;
};

Built build(const Polylines& contours, const ContourOptions& options = {.centers = few_centers}) {
  Built built{reconstruct_contours(contours, options), {}, bounding_box<3>(contours.vertices).diagonal()};
  built.mesh = polygonize(*built.surface.field, {.resolution = resolution});
  return built;
}

Polylines cut(const Solid3& solid, double lo, double hi, int count, double reach = 1.8) {
  return ContourCutter(solid, reach, cells)(horizontal_cuts(lo, hi, count));
}

// Root mean square of a distance at the vertices between two heights, fraction of the diagonal.
double rms(const Built& built, const Solid3& distance, double lo = -10, double hi = 10) {
  double sum = 0;
  Index count = 0;
  for (const auto& p : built.mesh.vertices.colwise()) {
    if (p.z() < lo || p.z() > hi) continue;
    const double d = distance(p);
    sum += d * d;
    ++count;
  }
  return std::sqrt(sum / static_cast<double>(count)) / built.diagonal;
}

TEST(ReconstructContours, FindsASphereBetterTheMoreSlicesThereAre) {
  // Most of the error is at the poles, half a spacing beyond the last slice: at least of first order.
  const double four = rms(build(cut(sphere, -1, 1, 4, 1.2)), sphere),
               eight = rms(build(cut(sphere, -1, 1, 8, 1.2)), sphere),
               sixteen = rms(build(cut(sphere, -1, 1, 16, 1.2)), sphere);
  EXPECT_LT(four, 3e-3);
  EXPECT_LT(eight, 0.5 * four);
  EXPECT_LT(sixteen, 0.6 * eight);
}

TEST(ReconstructContours, MeetsTheContoursWithNormalsOutwards) {
  const Polylines contours = cut(sphere, -1, 1, 8, 1.2);
  const Built built = build(contours);
  const ReconstructReport& report = built.surface.report;
  EXPECT_EQ(report.method, "contours");
  EXPECT_EQ(report.contours->contours, 8);
  EXPECT_EQ(report.contours->slices, 8);
  EXPECT_EQ(report.contours->caps, 0);
  EXPECT_EQ(report.smoothing, 0);
  EXPECT_EQ(report.points_used, contours.vertices.cols());
  EXPECT_LT(report.max_distance, 2e-5);  // what needs no correction
  expect_closed(built.mesh, 1, 2);
  double worst = 1;
  for (std::size_t i = 0; i < built.surface.source.size(); ++i) {
    const Point<3> p = contours.vertices.col(built.surface.source[i]);
    worst = std::min(worst, built.surface.normals.col(static_cast<Index>(i)).dot(p));
  }
  EXPECT_GT(worst, std::cos(10 * pi / 180));  // at the last slices, whose tilt is extrapolated
}

TEST(ReconstructContours, FindsAnEllipsoidThatIsTiltedAgainstTheSlices) {
  const double half = 1.2;  // about its height
  const Built built = build(cut(ellipsoid, -half, half, 10));
  expect_closed(built.mesh, 1, 2);
  EXPECT_LT(rms(built, ellipsoid), 2e-3);
}

TEST(ReconstructContours, JoinsTwoCurvesOfASliceIntoATorus) {
  const double top = Torus{}.major + Torus{}.minor;
  const Built coarse = build(cut(torus, -top, top, 8)), fine = build(cut(torus, -top, top, 14), {.centers = 1400});
  EXPECT_EQ(fine.surface.report.contours->slices, 14);
  EXPECT_GT(fine.surface.report.contours->contours, 14);
  expect_closed(coarse.mesh, 1, 0);
  expect_closed(fine.mesh, 1, 0);
  EXPECT_LT(rms(coarse, torus), 3e-3);
  EXPECT_LT(rms(fine, torus), 0.7 * rms(coarse, torus));
}

TEST(ReconstructContours, MakesAHoleOfACurveWithinAnother) {
  // Around z every slice is a ring.
  const auto ring = [](const Point<3>& p) { return Torus{}.depth(p); };
  const Built built = build(cut(ring, -Torus{}.minor, Torus{}.minor, 6, 1.5));
  EXPECT_EQ(built.surface.report.contours->contours, 12);
  expect_closed(built.mesh, 1, 0);
  EXPECT_LT(rms(built, ring), 2e-3);
}

TEST(ReconstructContours, BuildsAVentricleWithACavityAndALidAroundIt) {
  const Built built = build(cut(cup, -1.5, 0.1, 10, 1.4));
  expect_closed(built.mesh, 1, 2);
  EXPECT_GE(built.surface.report.contours->caps, 1);
  EXPECT_LT(rms(built, cup, -1.3, 0), 5e-3);
  EXPECT_LT((*built.surface.field)({-0.15, 0, -0.5}), 0);   // in the cavity
  EXPECT_GT((*built.surface.field)({-0.35, 0, -1.25}), 0);  // below it
}

TEST(ReconstructContours, LetsOneCurveBecomeTwo) {
  const Built built = build(cut(branches, -1, 1, 10));
  expect_closed(built.mesh, 1, 2);
  EXPECT_EQ(built.surface.report.contours->caps, 2);
  EXPECT_LT(rms(built, branches, -0.9, 0.9), 8e-3);  // its crotch is a sharp crease
}

TEST(ReconstructContours, ClosesATubeHalfASpacingBeyondItsEnds) {
  const auto tube = [](const Point<3>& p) { return 0.6 - std::hypot(p.x() - 0.4 * p.z(), p.y()); };
  constexpr int count = 8;
  const Built built = build(cut(tube, -1, 1, count, 1.2));
  expect_closed(built.mesh, 1, 2);
  const Box<3> box = bounding_box<3>(built.mesh.vertices);
  EXPECT_NEAR(box.hi.z(), 1, 0.05);
  EXPECT_NEAR(box.lo.z(), -1, 0.05);
  const double last = 1 - 1.0 / count;
  EXPECT_LT(rms(built, tube, -last, last), 1e-3);
}

TEST(ReconstructContours, TakesUnevenSpacing) {
  std::vector<Cut> cuts;
  for (const double z : {-0.93, -0.8, -0.65, -0.3, -0.15, 0.35, 0.6, 0.9})
    cuts.push_back({{0, 0, z}, Point<3>::UnitZ()});
  const Built built = build(ContourCutter(sphere, 1.2, cells)(cuts));
  expect_closed(built.mesh, 1, 2);
  EXPECT_LT(rms(built, sphere), 2e-3);
}

TEST(ReconstructContours, TakesSlicesOfDifferentDirections) {
  // Short axis views, and three long axis views that show both ends.
  std::vector<Cut> cuts = horizontal_cuts(-0.7, 0.7, 4);
  for (const double angle : {0.0, pi / 3, 2 * pi / 3})
    cuts.push_back({{0, 0, 0}, {std::cos(angle), std::sin(angle), 0}});
  const Built built = build(ContourCutter(ellipsoid, 1.8, cells)(cuts));
  EXPECT_EQ(built.surface.report.contours->slices, 7);
  EXPECT_EQ(built.surface.report.contours->caps, 0);
  expect_closed(built.mesh, 1, 2);
  EXPECT_LT(rms(built, ellipsoid), 2e-3);
}

TEST(ReconstructContours, TurnsMovesAndScalesWithTheContours) {
  const Polylines contours = cut(cup, -1.5, 0.1, 8, 1.4);
  Similarity move = rotation(0.8);
  move.scale = 250;
  move.shift = {1e3, -2e3, 30};
  Polylines moved = contours;
  moved.vertices = move(contours.vertices);
  const ContourOptions options{.centers = few_centers};
  const Reconstruction here = reconstruct_contours(contours, options), there = reconstruct_contours(moved, options);
  const Points<3> x = random_points(500, bounding_box<3>(contours.vertices).inflated(0.1), 3);
  const Eigen::VectorXd expected = move.scale * here.field->evaluate(x).value;
  EXPECT_LT((there.field->evaluate(move(x)).value - expected).cwiseAbs().maxCoeff(), 1e-4 * move.scale);
}

TEST(ReconstructContours, MeetsContoursWithMorePointsThanItsBudget) {
  const auto folded = [](const Point<3>& p) {
    return 1 + 0.05 * std::cos(9 * std::atan2(p.y(), p.x())) * (1 - p.z() * p.z()) - p.norm();
  };
  const Polylines contours = ContourCutter(folded, 1.3, 60)(horizontal_cuts(-1, 1, 8));
  const Built built = build(contours, {.centers = 300});
  EXPECT_GT(built.surface.report.points_used, 1000);
  EXPECT_LT(built.surface.report.max_distance, 1e-3);
  expect_closed(built.mesh, 1, 2);
}

TEST(ReconstructContours, SmoothsContoursThatWereDrawnUnsteadily) {
  Polylines contours = cut(sphere, -1, 1, 16, 1.2);
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 0.02);
  for (Index i = 0; i < contours.vertices.cols(); ++i) contours.vertices.col(i).head<2>() *= 1 + noise(random);
  const auto roughness = [](const Built& built) {
    double sum = 0;
    for (Index i = 0; i < built.mesh.vertices.cols(); ++i)
      sum += 1 - built.mesh.normals.col(i).dot(built.mesh.vertices.col(i).normalized());
    return std::sqrt(2 * sum / static_cast<double>(built.mesh.vertices.cols()));  // of the angle
  };
  const double exact = roughness(build(contours, {.centers = few_centers, .smoothing = 0.0}));
  EXPECT_GT(exact, 0.1);
  EXPECT_LT(roughness(build(contours, {.centers = few_centers, .smoothing = 1e-3})), 0.3 * exact);
}

TEST(ReconstructContours, RecognisesContoursTracedFromPixelsAndSmoothsThem) {
  const auto pixels = [](const Point<3>& p) {
    constexpr double size = 0.06;
    const auto middle = [](double x) { return size * (std::floor(x / size) + 0.5); };
    return sphere({middle(p.x()), middle(p.y()), p.z()});
  };
  const Polylines contours = ContourCutter(pixels, 1.2, 160)(horizontal_cuts(-1, 1, 10));
  const Built built = build(contours);
  EXPECT_EQ(built.surface.report.smoothing, 1e-3);
  ASSERT_EQ(built.surface.report.warnings.size(), 1U);
  EXPECT_NE(built.surface.report.warnings[0].find("jagged"), std::string::npos);
  expect_closed(built.mesh, 1, 2);
  EXPECT_LT(rms(built, sphere), 0.01);  // about a third of a pixel
}

TEST(ReconstructContours, ClosesOpenCurvesAndSaysSo) {
  Polylines contours = cut(sphere, -1, 1, 6, 1.2);
  contours.edges.conservativeResize(2, contours.edges.cols() - 1);
  const Built built = build(contours);
  ASSERT_EQ(built.surface.report.warnings.size(), 1U);
  EXPECT_NE(built.surface.report.warnings[0].find("1 open contour"), std::string::npos);
  expect_closed(built.mesh, 1, 2);
}

TEST(ReconstructContours, RefusesWhatIsNoSetOfContours) {
  const Polylines contours = cut(sphere, -1, 1, 4, 1.2);
  const auto message = [](const Polylines& lines, const ContourOptions& options = {}) {
    return invalid_input_message([&] { reconstruct_contours(lines, options); });
  };
  EXPECT_NE(message(contours, {.centers = 3}).find("centers = 3: must be at least 16"), std::string::npos);
  EXPECT_NE(message(contours, {.smoothing = -1}).find("smoothing = -1"), std::string::npos);
  EXPECT_NE(message({}).find("at least two closed curves"), std::string::npos);
  EXPECT_NE(message(cut(sphere, -1, 1, 1, 1.2)).find("contours of at least two planes"), std::string::npos);

  Polylines broken = contours;
  broken.edges.conservativeResize(2, broken.edges.cols() + 1);
  const auto count = static_cast<std::int32_t>(broken.vertices.cols());
  broken.edges.rightCols(1) << 0, count - 1;
  EXPECT_NE(message(broken).find("has more than two edges"), std::string::npos);
  broken.edges.rightCols(1) << 0, count;
  EXPECT_NE(message(broken).find("its ends must be vertices"), std::string::npos);
  broken = contours;
  broken.vertices(1, 5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(broken).find("must be finite"), std::string::npos);
  broken = contours;
  broken.vertices(2, 0) += 0.3;
  EXPECT_NE(message(broken).find("is not planar"), std::string::npos);
  broken = contours;
  broken.vertices.row(1).setZero();
  EXPECT_NE(message(broken).find("its points are collinear"), std::string::npos);
}

TEST(ReconstructContours, CanBeStopped) {
  const ContourOptions options{.progress = [](std::string_view, double) { return false; }};
  EXPECT_THROW(reconstruct_contours(cut(sphere, -1, 1, 4, 1.2), options), Cancelled);
}

}  // namespace
}  // namespace csrbf::reconstruct_contours_test
