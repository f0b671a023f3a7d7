#include "csrbf/surface/composite/join_pieces.hpp"

#include "surface/patch_testing.hpp"

namespace csrbf::join_pieces_test {
namespace {

// Samples of the faces of a box around 0, as dense everywhere, with exact normals.
OrientedPoints box_cloud(const Point<3>& half, double spacing) {
  PointCloud cloud{Points<3>(3, 0), Points<3>(3, 0), {}};
  double area = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double face = 4 * half[u] * half[v];
    for (const double side : {-1.0, 1.0}) {
      area += face;
      const auto n = static_cast<Index>(face / (spacing * spacing)), first = cloud.points.cols();
      cloud.points.conservativeResize(3, first + n);
      cloud.normals.conservativeResize(3, first + n);
      for (Index i = 0; i < n; ++i) {
        const Eigen::Vector2d uv = 2 * quasi_random(i, axis + (side > 0 ? 4 : 1)) - Eigen::Vector2d(1, 1);
        Point<3> p;
        p[axis] = side * half[axis];
        p[u] = uv[0] * half[u];
        p[v] = uv[1] * half[v];
        cloud.points.col(first + i) = p;
        cloud.normals.col(first + i) = side * Point<3>::Unit(axis);
      }
    }
  }
  return oriented(cloud, area);
}

Point<3> direction(Index i) {
  const Eigen::Vector2d uv = quasi_random(i, 9);
  const double z = 2 * uv[0] - 1, r = std::sqrt(1 - z * z);
  return {r * std::cos(2 * pi * uv[1]), r * std::sin(2 * pi * uv[1]), z};
}

double inside_box(const Point<3>& half, const Point<3>& x) {
  return (half - x.cwiseAbs()).minCoeff();
}

TEST(JoinPieces, KeepsEdgesCornersAndThinPlatesExactly) {
  constexpr double spacing = 0.05;
  // Sides of a plate have too few samples near its corners.
  const Point<3> cube(1, 1, 1), plate(1, 1, 0.75 * spacing), face(0.2, 0.1, 1), side(1, 0.3, 0), edge(1, 1, 0);
  struct Place {
    Point<3> half, at;
    std::size_t pieces;
  };
  for (const auto& [half, at, pieces] :
       {Place{cube, face, 1}, {cube, edge, 2}, {cube, {1, 1, 1}, 3}, {plate, face, 2}, {plate, side, 3}}) {
    const FittedPatch fitted = fit_around(box_cloud(half, spacing), at.cwiseProduct(half), quadric_only(8));
    EXPECT_EQ(fitted.pieces.size(), pieces) << at.transpose();
    const double radius = fitted.frame().radius;
    for (int t = 0; t < 200; ++t) {
      const Point<3> y = fitted.frame().center + 0.5 * radius * direction(t);
      EXPECT_NEAR(value(fitted, y), inside_box(half, y), 1e-3 * radius) << at.transpose();
    }
  }
}

TEST(JoinPieces, SeparatesSheetsThatFaceEachOther) {
  // The air between two half spaces, 1.5 spacings wide.
  constexpr double spacing = 0.04, gap = 1.5 * spacing;
  PointCloud below{Points<3>(3, 2500), Point<3>::UnitZ().replicate(1, 2500), {}}, above = below;
  for (Index i = 0; i < 2500; ++i) {
    const Eigen::Vector2d a = 2 * quasi_random(i, 1) - Eigen::Vector2d(1, 1),
                          b = 2 * quasi_random(i, 5) - Eigen::Vector2d(1, 1);
    below.points.col(i) << a, 0;
    above.points.col(i) << b, gap;
  }
  above.normals = -above.normals;
  OrientedPoints cloud = oriented(joined(below, above), 8);
  const FittedPatch fitted = fit_around(cloud, Point<3>(0, 0, -0.2 * spacing), quadric_only(8));
  ASSERT_EQ(fitted.pieces.size(), 2U);
  const double radius = fitted.frame().radius;
  for (const double z : {-0.5, -0.1, 0.3, 0.75, 1.2, 2.0})
    EXPECT_NEAR(
        value(fitted, fitted.frame().center + Point<3>(0.2 * radius, 0, z * spacing - fitted.frame().center[2])),
        std::max(-z * spacing, z * spacing - gap), 1e-3 * radius)
        << z;
}

}  // namespace
}  // namespace csrbf::join_pieces_test
