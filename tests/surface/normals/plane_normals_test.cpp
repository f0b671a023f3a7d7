#include "csrbf/surface/normals/plane_normals.hpp"

#include "csrbf/surface/estimate_normals.hpp"
#include "surface/oriented_shapes.hpp"

#include <Eigen/Eigenvalues>

namespace csrbf::plane_normals_test {
namespace {

// Those of planes through k points, on the side of the exact ones, in single precision as files have them.
Points<3> plane_normals(const Shape& shape, Index k) {
  const KdTree<3> tree(shape.points);
  Points<3> normals(3, shape.size());
  std::vector<Index> ids(k);
  std::vector<double> squared(k);
  for (Index i = 0; i < shape.size(); ++i) {
    tree.nearest(shape.points.col(i), k, ids.data(), squared.data());
    Points<3> near = shape.points(Eigen::all, ids);
    near.colwise() -= near.rowwise().mean().eval();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(near * near.transpose());
    const Point<3> n = axes.eigenvectors().col(0);
    normals.col(i) = (n.dot(shape.normals.col(i)) < 0 ? Point<3>(-n) : n).cast<float>().cast<double>();
  }
  return normals;
}

double mean_angle(const Points<3>& a, const Points<3>& b) {
  return (a.cwiseProduct(b).colwise().sum().array().min(1).max(-1)).acos().mean();
}

TEST(PlaneNormals, AreToldByTheirNumberOfNeighbors) {
  for (const double noise : {0.0, 0.005, 0.02})
    for (const Index k : {8, 16, 30, 50}) {
      const Shape torus = random_torus(4000, 3, noise);
      EXPECT_EQ(neighbors_of_planes(torus.points, KdTree<3>(torus.points), plane_normals(torus, k)), k);
    }
}

TEST(PlaneNormals, AreNotExactNormals) {
  for (const double noise : {0.0, 0.005, 0.02}) {
    const Shape torus = random_torus(4000, 3, noise);
    EXPECT_EQ(neighbors_of_planes(torus.points, KdTree<3>(torus.points), torus.normals), 0);
  }
  const Shape box = random_box({1, 0.7, 0.4}, 0.03, 5);  // most planes are those of its faces
  EXPECT_EQ(neighbors_of_planes(box.points, KdTree<3>(box.points), box.normals), 0);
}

// The planes of more points mix both sheets, and are far from those of few.
TEST(PlaneNormals, AreNotExactNormalsOfAThinShell) {
  const Shape outer = random_sphere(6000, 1);
  for (const double spacings : {2, 4}) {
    const Shape shell = join(outer, random_sphere(6000, 2, Point<3>::Zero(), 1 - spacings * outer.spacing()));
    EXPECT_EQ(neighbors_of_planes(shell.points, KdTree<3>(shell.points), shell.normals), 0);
  }
}

TEST(PlaneNormals, AreNotThoseOfOurOwnEstimate) {
  const Shape torus = random_torus(4000, 3, 0.01);
  const Points<3> estimated = estimate_normals(torus.points);
  EXPECT_EQ(neighbors_of_planes(torus.points, KdTree<3>(torus.points), estimated), 0);
}

TEST(PlaneNormals, GiveTheirSideToBetterOnes) {
  const Shape torus = random_torus(4000, 3, 0.04);
  const Points<3> given = -plane_normals(torus, 10), exact = -torus.normals;
  const NeighborTable near = make_neighbor_table(torus.points, KdTree<3>(torus.points), 9);
  const Points<3> better = on_given_side(estimate_normals(torus.points), given, near);
  EXPECT_LT(mean_angle(better, exact), 0.7 * mean_angle(given, exact));
  EXPECT_GT((better.cwiseProduct(exact).colwise().sum().array() > 0).cast<double>().mean(), 0.998);
}

}  // namespace
}  // namespace csrbf::plane_normals_test
