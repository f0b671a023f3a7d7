#include "csrbf/implicit/ridges.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "implicit/analytic_fields.hpp"

#include <gtest/gtest.h>

namespace csrbf::ridges_test {
namespace {

const Point<3> axes(3, 2, 1);

Index lines_in(const Polylines& curves) {
  DisjointSets sets(static_cast<std::size_t>(curves.vertices.cols()));
  for (Index e = 0; e < curves.edges.cols(); ++e)
    sets.unite(static_cast<std::uint32_t>(curves.edges(0, e)), static_cast<std::uint32_t>(curves.edges(1, e)));
  Index count = 0;
  for (std::uint32_t v = 0; v < curves.vertices.cols(); ++v) count += sets.find(v) == v ? 1 : 0;
  return count;
}

// Number of edges at each vertex.
Eigen::VectorXi valences(const Polylines& curves) {
  Eigen::VectorXi count = Eigen::VectorXi::Zero(curves.vertices.cols());
  for (Index i = 0; i < curves.edges.size(); ++i) ++count[curves.edges.data()[i]];
  return count;
}

// A grid of n x n vertices on the graph of `height` over the square from (x, y) = corner.
template <class Height>
Mesh graph(int n, const Point<2>& corner, double side, const Height& height) {
  Mesh sheet;
  sheet.vertices.resize(3, n * n);
  sheet.triangles.resize(3, 2 * (n - 1) * (n - 1));
  for (int j = 0, t = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int v = n * j + i;
      const Point<2> p = corner + side / (n - 1) * Point<2>(i, j);
      sheet.vertices.col(v) << p, height(p[0]);
      if (i + 1 == n || j + 1 == n) continue;
      sheet.triangles.col(t++) << v, v + 1, v + n + 1;
      sheet.triangles.col(t++) << v, v + n + 1, v + n;
    }
  return sheet;
}

const Eigen::VectorXd& kinds(const Polylines& curves) {
  return curves.properties[0].values;
}

TEST(Ridges, OfAnEllipsoidAreTheEllipseThroughItsTwoLongerAxes) {
  const AnalyticField field = ellipsoid(axes, {0.013, 0.007, 0.021});
  const Polylines found = ridges(field, polygonize(field, {.resolution = 40}));
  EXPECT_EQ(found.properties[0].name, "kind");
  EXPECT_EQ(found.properties[1].name, "curvature");
  EXPECT_GT(found.vertices.cols(), 80);
  EXPECT_EQ(lines_in(found), 1);
  EXPECT_TRUE((valences(found).array() == 2).all()) << "the ellipse is closed";
  EXPECT_TRUE((kinds(found).array() == 1).all());
  const Points<3> x = found.vertices.colwise() - Point<3>(0.013, 0.007, 0.021);
  // By symmetry the derivative of the curvature is zero there for differences too.
  EXPECT_LE(x.row(2).cwiseAbs().maxCoeff(), 1e-6);
  for (Index i = 0; i < x.cols(); ++i) {
    const double w = Point<2>(x(0, i) / 9, x(1, i) / 4).norm();
    EXPECT_NEAR(x(0, i) * x(0, i) / 9 + x(1, i) * x(1, i) / 4, 1, 1e-6);
    EXPECT_NEAR(found.properties[1].values[i], 1 / w, 1e-4);  // the curvature across: 1 / (c^2 |grad|)
  }
}

TEST(Ridges, OfTheOutsideAreValleys) {
  const AnalyticField hole(
      [](const AnalyticField::Variables& x) {
        return (1.0 / 9) * (x[0] * x[0]) + 0.25 * (x[1] * x[1]) + x[2] * x[2] - 1.0;
      },
      box_around(Point<3>::Zero(), axes), Point<3>(3, 0, 0));
  const Polylines found = ridges(hole, polygonize(hole, {.resolution = 41}));
  EXPECT_GT(found.vertices.cols(), 80);
  EXPECT_TRUE((kinds(found).array() == -1).all());
  EXPECT_LT(found.properties[1].values.maxCoeff(), 0);
  EXPECT_LE(found.vertices.row(2).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Ridges, OfAGrooveAreAValleyAtItsBottom) {
  const AnalyticField groove([](const AnalyticField::Variables& x) { return x[0] * x[0] - x[2] - 0.3; },
                             box_around(Point<3>::Zero(), Point<3>::Ones()));
  constexpr int n = 20;
  const Mesh sheet = graph(n, {-0.83, -0.8}, 1.6, [](double x) { return x * x - 0.3; });
  const Polylines found = ridges(groove, sheet);
  ASSERT_GT(found.vertices.cols(), n);
  EXPECT_EQ(lines_in(found), 1);
  EXPECT_TRUE((kinds(found).array() == -1).all());
  EXPECT_LE(found.vertices.row(0).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LE((found.properties[1].values.array() + 2).abs().maxCoeff(), 1e-6);
}

TEST(Ridges, AreFoundToSecondOrderWhereNoSymmetryHelps) {
  // The graph of z = -(x^2 + x^3) / 2: at its highest curvature w' = 0, w = z'' / (1 + z'^2)^(3/2).
  const AnalyticField bump(
      [](const AnalyticField::Variables& x) { return -0.5 * (x[0] * x[0] + x[0] * x[0] * x[0]) - x[2]; },
      box_around(Point<3>::Zero(), Point<3>::Ones()));
  const auto slope = [](double x) {  // of the curvature, times (1 + z'^2)^(5/2)
    const double z1 = -x - 1.5 * x * x, z2 = -1 - 3 * x, z3 = -3;
    return z3 * (1 + z1 * z1) - 3 * z1 * z2 * z2;
  };
  double lo = 0.1, hi = 0.9;
  while (hi - lo > 1e-14) ((slope(0.5 * (lo + hi)) < 0) == (slope(lo) < 0) ? lo : hi) = 0.5 * (lo + hi);
  std::vector<double> errors;
  for (const int n : {16, 32, 64}) {
    const Mesh sheet = graph(n, {0.013, 0}, 0.9, [](double x) { return -0.5 * (x * x + x * x * x); });
    const Polylines found = ridges(bump, sheet, {.least_turning = 0.5});
    ASSERT_GT(found.vertices.cols(), n);
    EXPECT_TRUE((kinds(found).array() == 1).all());
    errors.push_back((found.vertices.row(0).array() - lo).abs().maxCoeff());
  }
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_GE(std::log2(errors[i - 1] / errors[i]), 1.9);
}

TEST(Ridges, AreNotFoundWhereTheCurvatureIsConstant) {
  for (const AnalyticField& field : {ball(1, {0.01, 0.02, 0.03}), distance_torus(1, 0.4)})
    EXPECT_EQ(ridges(field, polygonize(field, {.resolution = 30}), {.least_turning = 0}).edges.cols(), 0);
}

TEST(Ridges, GrowWithTheSurface) {
  const AnalyticField small = ellipsoid(axes), large = ellipsoid(64 * axes);
  const Polylines a = ridges(small, polygonize(small, {.resolution = 25}));
  const Polylines b = ridges(large, polygonize(large, {.resolution = 25}));
  ASSERT_EQ(a.vertices.cols(), b.vertices.cols());
  EXPECT_EQ(a.edges, b.edges);
  EXPECT_LE((64 * a.vertices - b.vertices).cwiseAbs().maxCoeff(), 64 * 1e-9);
}

TEST(Ridges, ThatTurnTooLittleAreLeftOut) {
  const AnalyticField field = ellipsoid(axes);
  const Mesh mesh = polygonize(field, {.resolution = 25});
  // The normal turns by k1, between 2 and 3, times the length of the ellipse, between 5 pi - 0.2 and 5 pi + 0.2.
  EXPECT_GT(ridges(field, mesh, {.least_turning = 30}).edges.cols(), 0);
  EXPECT_EQ(ridges(field, mesh, {.least_turning = 48}).edges.cols(), 0);
}

TEST(Ridges, NeedAMeshAndValidOptions) {
  const AnalyticField field = ball(1);
  const Mesh mesh = polygonize(field, {.resolution = 8});
  EXPECT_NE(invalid_input_message([&] { ridges(field, Mesh{}); }).find("triangles = 0"), std::string::npos);
  EXPECT_NE(invalid_input_message([&] { ridges(field, mesh, {.least_turning = -1}); }).find("least_turning = -1"),
            std::string::npos);
  EXPECT_NE(invalid_input_message([&] { ridges(field, mesh, {.level = NAN}); }).find("level = nan"), std::string::npos);
  Mesh broken = mesh;
  broken.triangles(1, 3) = 1 << 30;
  EXPECT_NE(invalid_input_message([&] { ridges(field, broken); }).find("vertex index"), std::string::npos);
  EXPECT_THROW(ridges(field, mesh, {.progress = [](std::string_view, double) { return false; }}), Cancelled);
}

}  // namespace
}  // namespace csrbf::ridges_test
