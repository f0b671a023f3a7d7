#include "csrbf/surface/prepare/face_samples.hpp"

#include "implicit/mesh_testing.hpp"

#include <gtest/gtest.h>

namespace csrbf::face_samples_test {
namespace {

// A tetrahedron with its right angle at the origin and legs along the axes.
Mesh corner_of_a_cube() {
  Mesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 1, 0, 0,  //
      0, 0, 1, 0,               //
      0, 0, 0, 1;
  mesh.triangles.resize(3, 4);
  mesh.triangles << 0, 0, 0, 1,  //
      2, 1, 3, 2,                //
      1, 3, 2, 3;
  mesh.properties.push_back({"label", "uchar", Eigen::Vector4d(1, 2, 3, 4)});
  return mesh;
}

TEST(SamplesOfCoarseFaces, LieOnTheFacesWithTheirNormals) {
  const Mesh mesh = corner_of_a_cube();
  const PointCloud cloud = samples_of_coarse_faces(mesh).value();
  ASSERT_EQ(cloud.size(), 20'000);
  const Point<3> slanting = Point<3>::Constant(1 / std::sqrt(3.0));
  std::array<int, 4> count{};
  for (Index i = 0; i < cloud.size(); ++i) {
    const Point<3> p = cloud.points.col(i), n = cloud.normals.col(i);
    EXPECT_NEAR(n.norm(), 1, 1e-12);
    EXPECT_NEAR(n.dot(p), n[0] > 0 ? std::sqrt(1.0 / 3) : 0, 1e-12);
    const bool on_slanting = (n - slanting).norm() < 1e-12;
    ++count[on_slanting           ? 3
            : n.minCoeff() < -0.5 ? static_cast<int>(std::min_element(n.begin(), n.end()) - n.begin())
                                  : 0];
    Index nearest = 0;
    (mesh.vertices.colwise() - p).colwise().squaredNorm().minCoeff(&nearest);
    EXPECT_EQ(cloud.properties[0].values[i], mesh.properties[0].values[nearest]);
  }
  const double total = 1.5 + 0.5 * std::sqrt(3.0);  // areas
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(count[axis], 20'000 * 0.5 / total, 2);
  EXPECT_NEAR(count[3], 20'000 * 0.5 * std::sqrt(3.0) / total, 2);
}

TEST(SamplesOfCoarseFaces, AreNotNeededWhereVerticesSuffice) {
  EXPECT_FALSE(samples_of_coarse_faces(unit_sphere(20)));
  Mesh points;
  points.vertices = unit_sphere(3).vertices;
  EXPECT_FALSE(samples_of_coarse_faces(points));
}

TEST(SamplesOfCoarseFaces, LeaveOutFacesWithoutAreaAndKeepOtherPoints) {
  Mesh mesh = corner_of_a_cube();
  mesh.vertices.conservativeResize(3, 6);
  mesh.vertices.col(4).setConstant(std::numeric_limits<double>::quiet_NaN());
  mesh.vertices.col(5).setConstant(2);
  mesh.triangles.conservativeResize(3, 6);
  mesh.triangles.rightCols(2) << 0, 1,  //
      1, 1,                             //
      4, 2;
  mesh.properties[0].values = Eigen::VectorXd::Ones(6);
  const PointCloud cloud = samples_of_coarse_faces(mesh).value();
  ASSERT_EQ(cloud.size(), 20'002);
  EXPECT_TRUE(cloud.points.leftCols(20'000).allFinite());
  EXPECT_EQ(cloud.points.col(20'001), mesh.vertices.col(5));
  EXPECT_TRUE(cloud.normals.rightCols(2).isZero());
}

TEST(SamplesOfCoarseFaces, RefusesCorruptMeshes) {
  Mesh mesh = corner_of_a_cube();
  mesh.triangles(0, 0) = 4;
  EXPECT_THROW(samples_of_coarse_faces(mesh), InvalidInput);
}

}  // namespace
}  // namespace csrbf::face_samples_test
