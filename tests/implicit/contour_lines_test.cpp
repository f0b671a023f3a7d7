#include "csrbf/implicit/contour_lines.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"
#include "implicit/plane_fields.hpp"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace csrbf::contour_lines_test {
namespace {

using std::numbers::pi;

constexpr double rounding = 1e-13;  // sums of thousands of terms of the order of 1
const Point<2> off_lattice(0.013, -0.021);

PlaneField expression(const PlaneField::Expression& f, const Box<2>& bounds = square_box(1)) {
  return {f, bounds};
}

double polygon_area(const ContourLines& contours) {
  double area = 0;
  for (const ContourLine& line : contours.lines)
    for (Index i = 0; i < line.size; ++i) {
      const Point<2> p = contours.points.col(line.begin + i);
      const Point<2> q = contours.points.col(line.begin + (i + 1) % line.size);
      area += 0.5 * (p[0] * q[1] - p[1] * q[0]);
    }
  return area;
}

double polygon_length(const ContourLines& contours) {
  double length = 0;
  for (const ContourLine& line : contours.lines)
    for (Index i = 0; i < line.size; ++i)
      length += (contours.points.col(line.begin + i) - contours.points.col(line.begin + (i + 1) % line.size)).norm();
  return length;
}

TEST(ContourLines, OfAStraightEdgeAreExact) {
  const PlaneField field = expression([](const Taylor<2>& x, const Taylor<2>& y) { return 0.3 - x + 0.2 * y; },
                                      {Point<2>(0, 0), Point<2>(1, 1)});
  const ContourLines contours = contour_lines(field, {.resolution = 7});
  ASSERT_EQ(contours.lines.size(), 1U);
  EXPECT_TRUE(contours.lines[0].closed);
  EXPECT_NEAR(contours.area, 0.4, rounding);
  EXPECT_NEAR(contours.lines[0].area, 0.4, rounding);
  EXPECT_NEAR(polygon_area(contours), 0.4, rounding);
  EXPECT_NEAR(contours.length, std::hypot(1, 0.2), rounding);
  EXPECT_NEAR(polygon_length(contours), std::hypot(1, 0.2) + 1 + 0.3 + 0.5, rounding) << "along the border as well";
  EXPECT_NEAR(contours.length_error, 0, rounding);
  EXPECT_NEAR(contours.area_error, 0, rounding);
}

TEST(ContourLines, OfABoxThatIsAllInsideIsItsBorder) {
  const PlaneField field = expression([](const Taylor<2>&, const Taylor<2>&) { return Taylor<2>(1); });
  const ContourLines contours = contour_lines(field, {.resolution = 5});
  ASSERT_EQ(contours.lines.size(), 1U);
  Points<2> corners(2, 4);
  corners << -1, 1, 1, -1,  //
      -1, -1, 1, 1;
  EXPECT_EQ(contours.points, corners);
  EXPECT_NEAR(contours.area, 4, rounding);
  EXPECT_EQ(contours.length, 0);
  EXPECT_TRUE(contour_lines(field, {.resolution = 5, .ends = ContourEnds::open}).lines.empty());
}

TEST(ContourLines, AreNoneWhereNothingIsInside) {
  const PlaneField field = expression([](const Taylor<2>&, const Taylor<2>&) { return Taylor<2>(-1); });
  const ContourLines contours = contour_lines(field);
  EXPECT_TRUE(contours.lines.empty());
  EXPECT_EQ(contours.points.cols(), 0);
  EXPECT_EQ(contours.area, 0);
  EXPECT_EQ(contours.length, 0);
}

TEST(ContourLines, HavePointsOnTheContour) {
  const double r = 0.7;
  constexpr double step = 1e-7;  // of a cell: where Newton's method ends
  const int cells = 20;
  const ContourLines contours = contour_lines(ellipse(r, r, square_box(1), off_lattice), {.resolution = cells});
  ASSERT_EQ(contours.lines.size(), 1U);
  EXPECT_GT(contours.points.cols(), cells);
  for (Index i = 0; i < contours.points.cols(); ++i)
    EXPECT_NEAR((contours.points.col(i) - off_lattice).norm(), r, step * 2 / cells);
}

TEST(ContourLines, MeasureAnEllipse) {
  const double a = 0.9, b = 0.5;
  // Perimeter 4 a E(e), e^2 = 1 - b^2 / a^2.
  const double length = 4 * a * std::comp_ellint_2(std::sqrt(1 - b * b / (a * a))), area = pi * a * b;
  const ContourLines contours = contour_lines(ellipse(a, b, square_box(1), off_lattice), {.resolution = 200});
  EXPECT_NEAR(contours.length, length, 1e-7 * length);
  EXPECT_NEAR(contours.area, area, 1e-7 * area);
}

TEST(ContourLines, GoRoundRegionsAndBackRoundHoles) {
  const PlaneField field = ring(0.4, 0.8, square_box(1), off_lattice);
  const ContourLines contours = contour_lines(field, {.resolution = 50});
  ASSERT_EQ(contours.lines.size(), 2U);
  constexpr double fourth_order = 1e-5;
  EXPECT_NEAR(contours.lines[0].area, pi * 0.64, fourth_order);
  EXPECT_NEAR(contours.lines[1].area, -pi * 0.16, fourth_order);
  EXPECT_NEAR(contours.area, contours.lines[0].area + contours.lines[1].area, rounding);
  EXPECT_NEAR(contours.length, 2 * pi * 1.2, fourth_order);
  for (const ContourLine& line : contours.lines)
    for (Index i = 0; i + 1 < line.size; ++i) {
      const Point<2> p = contours.points.col(line.begin + i), chord = contours.points.col(line.begin + i + 1) - p;
      const Point<2> left(-chord[1], chord[0]);
      EXPECT_GT(field(p + 0.5 * chord + left), field(p + 0.5 * chord - left));
    }
}

TEST(ContourLines, ConnectTheCornersOfTheSaddlesSign) {
  const auto saddle = [](double middle) {
    return expression([=](const Taylor<2>& x, const Taylor<2>& y) { return middle + x * y; });
  };
  EXPECT_EQ(contour_lines(saddle(0.1), {.resolution = 1}).lines.size(), 1U);
  EXPECT_EQ(contour_lines(saddle(-0.1), {.resolution = 1}).lines.size(), 2U);
  // The region x y > c of the unit square has the area (1 - c + c ln c); both quadrants, and the rest by symmetry.
  const double region = 1 - 0.1 + 0.1 * std::log(0.1);
  constexpr double fourth_order = 1e-5;
  EXPECT_NEAR(contour_lines(saddle(-0.1), {.resolution = 64}).area, 2 * region, fourth_order);
  EXPECT_NEAR(contour_lines(saddle(0.1), {.resolution = 64}).area, 4 - 2 * region, fourth_order);
}

TEST(ContourLines, MayEndAtTheBorder) {
  const double r = 1.1;  // cuts all four sides of the box
  const PlaneField field = ellipse(r, r, square_box(1), off_lattice);
  const ContourLines closed = contour_lines(field, {.resolution = 40});
  const ContourLines open = contour_lines(field, {.resolution = 40, .ends = ContourEnds::open});
  ASSERT_EQ(closed.lines.size(), 1U);
  ASSERT_EQ(open.lines.size(), 4U);
  EXPECT_EQ(open.length, closed.length);
  EXPECT_EQ(open.area, closed.area);
  double polygon = 0;
  for (const ContourLine& line : open.lines) {
    EXPECT_FALSE(line.closed);
    EXPECT_EQ(line.area, 0);
    for (const Index end : {line.begin, line.begin + line.size - 1})
      EXPECT_EQ(open.points.col(end).cwiseAbs().maxCoeff(), 1);
    for (Index i = line.begin; i + 1 < line.begin + line.size; ++i)
      polygon += (open.points.col(i + 1) - open.points.col(i)).norm();
  }
  EXPECT_NEAR(polygon, open.length, 1.01 * open.length_error + rounding);
}

TEST(ContourLines, BoundAreasLikeThoseOfAFineLattice) {
  const PlaneField field = expression([](const Taylor<2>& x, const Taylor<2>& y) {
    const auto wave = [](const Taylor<2>& t) { return apply(t, std::sin(t.value), std::cos(t.value), 0); };
    return wave(7.0 * x + 2.0 * y) + wave(3.0 * x - 8.0 * y + 1.0) + 0.3 * wave(11.0 * y);
  });
  const ContourLines contours = contour_lines(field, {.resolution = 100, .level = 0.2});
  EXPECT_GT(contours.lines.size(), 4U);
  constexpr Index n = 1000;
  const Eigen::VectorXd axis = Eigen::VectorXd::LinSpaced(n, -1 + 1.0 / n, 1 - 1.0 / n);
  const Eigen::VectorXd values = field.evaluate_grid({axis, axis});
  const double counted = 4.0 * static_cast<double>((values.array() >= 0.2).count()) / (n * n);
  // Voxels cut by the contour are right or wrong at random: their number is about length / width.
  const double spread = 4.0 / (n * n) * std::sqrt(contours.length * n / 2);
  EXPECT_NEAR(contours.area, counted, 5 * spread);
  double sum = 0;
  for (const ContourLine& line : contours.lines) sum += line.area;
  EXPECT_NEAR(contours.area, sum, rounding);
}

TEST(ContourLines, AreTheSameForEveryNumberOfThreads) {
  const PlaneField field = ring(0.4, 0.8, square_box(1), off_lattice);
  const int before = thread_count();
  set_thread_count(1);
  const ContourLines one = contour_lines(field, {.resolution = 300});
  set_thread_count(3);
  const ContourLines three = contour_lines(field, {.resolution = 300});
  set_thread_count(before);
  EXPECT_EQ(one.points, three.points);
  EXPECT_EQ(one.area, three.area);
  EXPECT_EQ(one.length, three.length);
}

TEST(ContourLines, SurviveContoursThroughCornersOfCells) {
  // The contour |x| + |y| = 1 passes through corners and along diagonals of the cells; x = 0 along their edges.
  const auto magnitude = [](const Taylor<2>& t) { return t.value < 0 ? -1.0 * t : t; };
  const PlaneField diamond = expression(
      [&](const Taylor<2>& x, const Taylor<2>& y) { return 1.0 - magnitude(x) - magnitude(y); }, square_box(2));
  const ContourLines contours = contour_lines(diamond, {.resolution = 8});
  ASSERT_EQ(contours.lines.size(), 1U);
  EXPECT_NEAR(contours.area, 2, rounding);
  EXPECT_NEAR(contours.length, 4 * std::sqrt(2), rounding);
  for (Index i = 0; i < contours.points.cols(); ++i)
    EXPECT_GT((contours.points.col(i) - contours.points.col((i + 1) % contours.points.cols())).norm(), 1e-3);
  const PlaneField half = expression([](const Taylor<2>& x, const Taylor<2>&) { return x; });
  EXPECT_NEAR(contour_lines(half, {.resolution = 4}).area, 2, rounding);
  const PlaneField point = expression([](const Taylor<2>& x, const Taylor<2>& y) { return -1.0 * (x * x + y * y); });
  EXPECT_NEAR(contour_lines(point, {.resolution = 4}).area, 0, 1e-12)
      << "at most as large as the steps of Newton's method";
}

TEST(ContourLines, FindJumps) {
  const PlaneField step =
      expression([](const Taylor<2>& x, const Taylor<2>&) { return Taylor<2>(x.value < 0.3 ? 5.0 : -1.0); });
  EXPECT_NEAR(contour_lines(step, {.resolution = 10}).area, 2.6, 1e-6);
}

TEST(ContourLines, BecomeCurvesInSpace) {
  const ContourLines contours = contour_lines(ring(0.4, 0.8, square_box(1), off_lattice), {.resolution = 20});
  Eigen::Affine3d placement = Eigen::Affine3d::Identity();
  placement.translate(Point<3>(1, 2, 3)).scale(2);
  const Polylines lines = to_polylines(contours, placement.affine());
  ASSERT_EQ(lines.vertices.cols(), contours.points.cols());
  EXPECT_EQ(lines.edges.cols(), contours.points.cols()) << "closed lines have as many edges as points";
  for (Index i = 0; i < lines.vertices.cols(); ++i)
    EXPECT_EQ(lines.vertices.col(i), Point<3>(1 + 2 * contours.points(0, i), 2 + 2 * contours.points(1, i), 3));
  for (Index e = 0; e < lines.edges.cols(); ++e)
    EXPECT_EQ(lines.properties[0].values[lines.edges(0, e)], lines.properties[0].values[lines.edges(1, e)]);
  EXPECT_EQ(lines.properties[0].values.maxCoeff(), 1);
}

TEST(ContourLines, ConvergeAtFourthOrderAndTheirPolygonsAtSecond) {
  const double a = 0.83, b = 0.57;
  const double length = 4 * a * std::comp_ellint_2(std::sqrt(1 - b * b / (a * a))), area = pi * a * b;
  const PlaneField field = ellipse(a, b, square_box(1), off_lattice);
  Eigen::Matrix<double, 4, 5> errors;
  for (int k = 0; k < 5; ++k) {
    const ContourLines contours = contour_lines(field, {.resolution = 10 << k});
    errors.col(k) << std::abs(contours.length - length), std::abs(contours.area - area),
        std::abs(polygon_length(contours) - length), std::abs(polygon_area(contours) - area);
    EXPECT_LE(errors(0, k), contours.length_error);
    EXPECT_LE(errors(1, k), contours.area_error);
    EXPECT_LE(errors(2, k), 1.1 * contours.length_error) << "the estimate is that of the polygon";
    EXPECT_LE(errors(3, k), 1.1 * contours.area_error);
    EXPECT_GE(errors(3, k), 0.9 * contours.area_error);
  }
  // Over four halvings: where the lattice happens to cut the curve varies from one to the next.
  const Eigen::Vector4d order = (errors.col(0).array() / errors.col(4).array()).log2() / 4;
  EXPECT_GT(order[0], 3.9);
  EXPECT_GT(order[1], 3.9);
  EXPECT_GT(order[2], 1.9);
  EXPECT_GT(order[3], 1.9);
}

TEST(ContourLines, ChooseCellsAsLongAsTheDetail) {
  const auto constant = [](const Taylor<2>&, const Taylor<2>&) { return Taylor<2>(1); };
  EXPECT_EQ(automatic_resolution(PlaneField(constant, square_box(1), 0.01)), 200);
  EXPECT_EQ(automatic_resolution(PlaneField(constant, square_box(1), 1)), 32);
  EXPECT_EQ(automatic_resolution(PlaneField(constant, square_box(1), 1e-9)), 2048);
  EXPECT_EQ(automatic_resolution(PlaneField(constant, square_box(1))), 256);
}

TEST(ContourLines, RefuseWhatTheyCannotUse) {
  const PlaneField field = ellipse(0.5, 0.5, square_box(1));
  const auto message = [&](const ContourLinesOptions& options) {
    return invalid_input_message([&] { contour_lines(field, options); });
  };
  EXPECT_EQ(message({.resolution = -1}),
            "contour_lines: resolution = -1: must be between 1 and 16384 cells along the longest side, or 0 for "
            "automatic");
  EXPECT_EQ(message({.resolution = 20000}).find("contour_lines: resolution = 20000"), 0U);
  EXPECT_EQ(message({.level = NAN}), "contour_lines: level = nan: must be finite");
  EXPECT_EQ(
      message({.bounds = {Point<2>(0, 0), Point<2>(1, 0)}}),
      "contour_lines: bounds = 1 x 0: must have positive, finite extent along both axes; leave them out for those "
      "of the field");
  const PlaneField nowhere([](const Taylor<2>& x, const Taylor<2>&) { return x; }, {});
  EXPECT_EQ(invalid_input_message([&] { contour_lines(nowhere); }).find("contour_lines: field.bounds() = 0 x 0"), 0U);
  const PlaneField undefined = expression([](const Taylor<2>&, const Taylor<2>&) { return Taylor<2>(NAN); });
  try {
    contour_lines(undefined, {.resolution = 2});
    ADD_FAILURE() << "no exception";
  } catch (const SolverFailure& failure) {
    EXPECT_STREQ(failure.what(),
                 "contour_lines: the field is nan at (-1, -1): it must be finite; fix the field or shrink the bounds");
  }
  EXPECT_THROW(contour_lines(field, {.progress = [](const auto&...) { return false; }}), Cancelled);
}

// f = x^2 + y^2 in a square of half width 1.
PlaneField bowl() {
  return expression([](const Taylor<2>& x, const Taylor<2>& y) { return x * x + y * y; });
}

TEST(LevelLines, LieOnTheirLevelsWithHigherValuesOnTheLeft) {
  const std::vector<LevelLine> lines = level_lines(bowl(), {.levels = {0.25, 0.5, 1.21}, .resolution = 20});
  ASSERT_EQ(lines.size(), 6U) << "two circles, and four arcs in the corners";
  for (std::size_t n = 0; n < lines.size(); ++n) {
    const LevelLine& line = lines[n];
    EXPECT_EQ(line.level, n == 0 ? 0.25 : n == 1 ? 0.5 : 1.21);
    EXPECT_EQ(line.closed, n < 2);
    EXPECT_LT((line.points.colwise().norm().array() - std::sqrt(line.level)).abs().maxCoeff(), 1e-6);
    const Point<2> p = line.points.col(0), q = line.points.col(1);
    EXPECT_LT(p[0] * q[1] - p[1] * q[0], 0) << "the middle, where f is lower, is on the right";
  }
  const std::vector<LevelLine> again = level_lines(bowl(), {.levels = {0.5}, .resolution = 20});
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(again[0].points, lines[1].points);
}

TEST(LevelLines, AreAtRoundLevelsByDefault) {
  std::vector<double> levels;
  for (const LevelLine& line : level_lines(bowl(), {.resolution = 40}))
    if (levels.empty() || levels.back() != line.level) levels.push_back(line.level);
  EXPECT_EQ(levels, (std::vector<double>{0.2, 0.4, 0.6, 0.8, 1, 1.2, 1.4, 1.6, 1.8}));
  levels.clear();
  for (const LevelLine& line : level_lines(bowl(), {.step = 0.3, .resolution = 40}))
    if (levels.empty() || levels.back() != line.level) levels.push_back(line.level);
  EXPECT_EQ(levels.size(), 6U);
  EXPECT_TRUE(level_lines(expression([](const Taylor<2>& x, const Taylor<2>&) { return 0 * x + 3; })).empty());
}

TEST(LevelLines, EndWhereTheyAreNotWanted) {
  const auto right = [](const PointsRef<2>& points) {
    std::vector<bool> wanted(static_cast<std::size_t>(points.cols()));
    for (Index i = 0; i < points.cols(); ++i) wanted[static_cast<std::size_t>(i)] = points(0, i) > 0.1;
    return wanted;
  };
  const std::vector<LevelLine> lines = level_lines(bowl(), {.levels = {0.25}, .resolution = 50, .wanted = right});
  ASSERT_EQ(lines.size(), 1U) << "one arc, wherever the closed line began";
  EXPECT_FALSE(lines[0].closed);
  EXPECT_GT(lines[0].points.row(0).minCoeff(), 0.1);
  EXPECT_LT(lines[0].points.row(0).minCoeff(), 0.15);
  EXPECT_GT(lines[0].points.row(0).maxCoeff(), 0.49);
  const auto nowhere = [](const PointsRef<2>& points) {
    return std::vector<bool>(static_cast<std::size_t>(points.cols()), false);
  };
  EXPECT_TRUE(level_lines(bowl(), {.levels = {0.25}, .resolution = 50, .wanted = nowhere}).empty());
}

TEST(LevelLines, RefuseLevelsThatAreNone) {
  EXPECT_THROW((void)level_lines(bowl(), {.levels = {1, 0.5}}), InvalidInput);
  EXPECT_THROW((void)level_lines(bowl(), {.levels = {std::nan("")}}), InvalidInput);
  EXPECT_THROW((void)level_lines(bowl(), {.step = -1}), InvalidInput);
  EXPECT_THROW((void)level_lines(bowl(), {.step = 1e-6, .resolution = 4}), InvalidInput);
  EXPECT_THROW((void)level_lines(bowl(), {.levels = {1}, .step = 1}), InvalidInput);
}

}  // namespace
}  // namespace csrbf::contour_lines_test
