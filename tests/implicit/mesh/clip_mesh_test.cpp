#include "csrbf/implicit/mesh/clip_mesh.hpp"

#include "implicit/mesh_testing.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace csrbf::clip_mesh_test {
namespace {

double area(const Mesh& mesh) {
  double sum = 0;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Point<3> a = mesh.vertices.col(mesh.triangles(0, t)), b = mesh.vertices.col(mesh.triangles(1, t)),
                   c = mesh.vertices.col(mesh.triangles(2, t));
    sum += 0.5 * (b - a).cross(c - a).norm();
  }
  return sum;
}

TEST(ClipMesh, CutsATriangleWhereTheFunctionVanishes) {
  Mesh mesh = right_triangle();
  mesh.normals = Point<3>(0, 0, 3).replicate(1, 3);
  mesh.properties = {{"x", "float", mesh.vertices.row(0).transpose()}};
  const Mesh part = clip_mesh(mesh, Eigen::Vector3d(-0.5, 1.5, -0.5));  // x >= 0.5
  EXPECT_NEAR(area(part), 1.5 * 1.5 / 2, 1e-15);
  EXPECT_EQ(part.vertices.cols(), 3);
  EXPECT_NEAR(part.vertices.row(0).minCoeff(), 0.5, 1e-15);
  EXPECT_LT((part.normals.colwise() - Point<3>(0, 0, 3)).norm(), 1e-15);
  EXPECT_LT((part.properties[0].values - part.vertices.row(0).transpose()).norm(), 1e-15);
}

TEST(ClipMesh, HalfASphereIsADiscInTopologyAndFacesOutward) {
  const Mesh sphere = unit_sphere(40);
  const Mesh part = clip_mesh(sphere, (sphere.vertices.row(2).transpose().array() - 0.123).matrix());
  const Topology t = topology(part);
  EXPECT_EQ(t.euler, 1);
  EXPECT_EQ(t.inconsistent_edges, 0);
  EXPECT_TRUE(t.manifold());
  EXPECT_NEAR(area(part), 2 * std::numbers::pi * (1 - 0.123), 0.02);
  EXPECT_NEAR(part.vertices.row(2).minCoeff(), 0.123, 0.01);
}

TEST(ClipMesh, KeepsAllOrNothing) {
  const Mesh sphere = unit_sphere(6);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(sphere.vertices.cols());
  EXPECT_EQ(clip_mesh(sphere, ones).vertices, sphere.vertices);
  EXPECT_EQ(clip_mesh(sphere, ones).triangles, sphere.triangles);
  EXPECT_EQ(clip_mesh(sphere, -ones).vertices.cols(), 0);
  EXPECT_EQ(clip_mesh(sphere, -ones).triangles.cols(), 0);
}

TEST(ClipMesh, NeedsAValuePerVertex) {
  EXPECT_EQ(invalid_input_message([] { clip_mesh(right_triangle(), Eigen::Vector2d(1, 1)); }),
            "clip_mesh: value.size() = 2: must be one per vertex");
}

}  // namespace
}  // namespace csrbf::clip_mesh_test
