#include "csrbf/implicit/polygonize/center_vertices.hpp"

#include "implicit/polygonize_fields.hpp"

#include <Eigen/Geometry>

namespace csrbf::polygonization::center_vertices_test {
namespace {

constexpr double side = 0.125;
const CellLattice lattice{Point<3>::Constant(-1), Point<3>(side, 2 * side, 2 * side), Cell(16, 8, 8)};

// Vertices at distances from a sphere of radius 1/2, in cells, with the given normal.
Mesh around_sphere(const std::vector<double>& cells, const Point<3>& normal) {
  const Point<3> direction = Point<3>(2, -1, 2) / 3;
  Mesh mesh;
  mesh.vertices.resize(3, static_cast<Index>(cells.size()));
  for (std::size_t i = 0; i < cells.size(); ++i)
    mesh.vertices.col(static_cast<Index>(i)) = (0.5 + side * cells[i]) * direction;
  mesh.normals = normal.replicate(1, mesh.vertices.cols());
  return mesh;
}

const Point<3> outward = Point<3>(2, -1, 2) / 3;

TEST(CenterVertices, GoToTheSurfaceButNotFurtherThanAQuarterOfACell) {
  const std::vector<double> cells{0.2, -0.2, 0.24, -0.1, 0.01, 0, 0.9, -0.9, 0.3};
  const Implicit ball = sphere(0.5, Point<3>::Zero());
  LevelSampler sampler(ball, 0);
  Mesh mesh = around_sphere(cells, Point<3>::Zero());
  place_center_vertices(lattice, sampler, 0, true, mesh);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double left = std::copysign(std::max(0.0, std::abs(cells[i]) - 0.25), cells[i]);
    EXPECT_LT((mesh.vertices.col(static_cast<Index>(i)) - (0.5 + side * left) * outward).norm(), 1e-8) << cells[i];
    EXPECT_LT((mesh.normals.col(static_cast<Index>(i)) - outward).norm(), 1e-12);
  }
}

TEST(CenterVertices, BeforeTheFirstAndWithoutRefinementStayInPlace) {
  const Implicit ball = sphere(0.5, Point<3>::Zero());
  LevelSampler sampler(ball, 0);
  const Mesh before = around_sphere({0.2, 0.2, 0.2}, Point<3>::Zero());
  Mesh mesh = before;
  place_center_vertices(lattice, sampler, 2, true, mesh);
  EXPECT_EQ(mesh.vertices.leftCols(2), before.vertices.leftCols(2));
  EXPECT_EQ(mesh.normals.leftCols(2), before.normals.leftCols(2));
  EXPECT_NEAR(mesh.vertices.col(2).norm(), 0.5, 1e-8);
  mesh = before;
  place_center_vertices(lattice, sampler, 0, false, mesh);
  EXPECT_EQ(mesh.vertices, before.vertices);
  EXPECT_LT((mesh.normals.colwise() - outward).norm(), 1e-12);
}

// Once where refinement is not wanted, never where normals are not either; until a step is below 1e-3 of a cell, or
// below 1e-2 along a gradient that is the normal known before.
TEST(CenterVertices, EvaluateNoMoreThanTheyNeed) {
  const Implicit ball = sphere(0.5, Point<3>::Zero());
  const auto evaluations = [&](double cells, bool refine, bool normals, const Point<3>& known = Point<3>::Zero()) {
    LevelSampler sampler(ball, 0);
    Mesh mesh = around_sphere({cells}, known);
    if (!normals) mesh.normals.resize(3, 0);
    place_center_vertices(lattice, sampler, 0, refine, mesh);
    return sampler.gradient_count();
  };
  EXPECT_EQ(evaluations(0.2, false, true), 1);
  EXPECT_EQ(evaluations(0.2, false, false), 0);
  EXPECT_EQ(evaluations(0.0005, true, true), 1);
  EXPECT_EQ(evaluations(0.05, true, true), 2);
  EXPECT_EQ(evaluations(0.05, true, false), 2);
  EXPECT_EQ(evaluations(0.008, true, true), 2);
  EXPECT_EQ(evaluations(0.008, true, true, outward), 1);
  EXPECT_EQ(evaluations(0.008, true, true, (outward + 0.2 * outward.unitOrthogonal()).normalized()), 2);
  EXPECT_EQ(evaluations(0.015, true, true, outward), 2);
}

TEST(CenterVertices, KeepNormalsThatAreFarFromTheGradient) {
  const Implicit ball = sphere(0.5, Point<3>::Zero());
  const Point<3> across = outward.unitOrthogonal();
  for (const double degrees : {0.0, 10.0, 25.0, 60.0, 120.0}) {  // the cosine of 18 degrees is 0.95
    LevelSampler sampler(ball, 0);
    const Point<3> known = std::cos(degrees * pi / 180) * outward + std::sin(degrees * pi / 180) * across;
    Mesh mesh = around_sphere({0.1}, known);
    place_center_vertices(lattice, sampler, 0, true, mesh);
    EXPECT_LT((mesh.normals.col(0) - (degrees < 18 ? outward : known)).norm(), 1e-12) << degrees;
  }
}

TEST(CenterVertices, StayWhereTheirStepsDoNotBringThemNearer) {
  const Implicit wrong([](const Point<3>& p, Point<3>& g) { return g = Point<3>::UnitX(), 1 - p[0]; }, cube(1));
  LevelSampler sampler(wrong, 0);  // f grows along its gradient's downhill side
  Mesh mesh = around_sphere({0}, Point<3>::Zero());
  const Point<3> before = mesh.vertices.col(0);
  place_center_vertices(lattice, sampler, 0, true, mesh);
  EXPECT_EQ(mesh.vertices.col(0), before);
}

TEST(CenterVertices, OnCapsStayAsTheyAre) {
  const Implicit ball = sphere(0.9, Point<3>::Zero());
  LevelSampler sampler(ball, 0);
  Mesh mesh;
  mesh.vertices = Point<3>(0.2, 0.3, lattice.capped_box().hi[2]);
  mesh.normals = Point<3>::UnitZ();
  place_center_vertices(lattice, sampler, 0, true, mesh);
  EXPECT_EQ(mesh.vertices.col(0), Point<3>(0.2, 0.3, lattice.capped_box().hi[2]));
  EXPECT_EQ(mesh.normals.col(0), Point<3>(0, 0, 1));
}

}  // namespace
}  // namespace csrbf::polygonization::center_vertices_test
