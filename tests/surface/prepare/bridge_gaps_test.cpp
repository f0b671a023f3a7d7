#include "csrbf/surface/prepare/bridge_gaps.hpp"

#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "surface/oriented_shapes.hpp"
#include "surface/surface_testing.hpp"

#include <functional>

namespace csrbf {
namespace {

constexpr Index capsule_samples = 12000;
constexpr double half_length = 3;

// Signed distance to a capsule of radius 1 around the z axis, positive inside.
double depth(const Point<3>& p) {
  return 1 - (p - Point<3>(0, 0, std::clamp(p[2], -half_length, half_length))).norm();
}

// Evenly spread samples of the capsule.
PointCloud capsule() {
  PointCloud cloud{Points<3>(3, capsule_samples), Points<3>(3, capsule_samples), {}};
  for (Index i = 0; i < capsule_samples; ++i) {
    const Eigen::Vector2d uv = quasi_random(i, 1);
    const double z = (half_length + 1) * (2 * uv[0] - 1), phi = 2 * pi * uv[1];
    const double cap = std::max(0.0, std::abs(z) - half_length), rho = std::sqrt(1 - cap * cap);
    cloud.normals.col(i) << rho * std::cos(phi), rho * std::sin(phi), std::copysign(cap, z);
    cloud.points.col(i) << cloud.normals(0, i), cloud.normals(1, i), z;
  }
  return cloud;
}

PointCloud part(const PointCloud& cloud, const std::function<bool(const Point<3>&)>& kept) {
  std::vector<Index> ids;
  for (Index i = 0; i < cloud.size(); ++i)
    if (kept(cloud.points.col(i))) ids.push_back(i);
  return {cloud.points(Eigen::all, ids), cloud.normals(Eigen::all, ids), {}};
}

PointCloud cut_capsule(double from, double to) {
  return part(capsule(), [&](const Point<3>& p) { return p[2] < from || p[2] > to; });
}

Index joined_parts(const PointCloud& cloud) {
  PreparedCloud prepared = prepare(cloud, Normals::file);
  return bridge_gaps(prepared);
}

TEST(BridgeGaps, JoinsTheTipOfAFingerToTheRest) {
  const PointCloud cloud =
      cut_capsule(-0.4, 2.6);  // a gap half again as wide as the finger, and the winding number is decided
  const Reconstruction result = reconstruct(cloud);
  const Mesh mesh = polygonize(*result.field);
  expect_closed(mesh, 1, 2);
  double farthest = 0;
  for (Index i = 0; i < mesh.vertices.cols(); ++i) farthest = std::max(farthest, std::abs(depth(mesh.vertices.col(i))));
  EXPECT_LT(farthest, 0.15);  // of the radius, in the middle of the gap
  ASSERT_EQ(result.report.warnings.size(), 1U);
  EXPECT_EQ(result.report.warnings.front(), "1 part separated by gaps in the data: joined to the rest");
}

TEST(BridgeGaps, JoinsAPieceThatIsOpenAtBothEnds) {
  const PointCloud cloud =
      part(capsule(), [](const Point<3>& p) { return p[2] < -1.8 || (p[2] > -0.3 && p[2] < 1) || p[2] > 2.5; });
  expect_closed(polygonize(*reconstruct(cloud).field), 1, 2);
}

TEST(BridgeGaps, AddsSamplesOfTheSurfaceBehindThoseGiven) {
  const PointCloud cloud = cut_capsule(-0.4, 2.6);
  const PreparedCloud before = prepare(cloud, Normals::file);
  PreparedCloud after = prepare(cloud, Normals::file);
  ASSERT_EQ(after.components.size(), 1U);
  EXPECT_EQ(bridge_gaps(after), 1);
  const Index given = before.cloud.size();
  EXPECT_EQ(after.cloud.points.leftCols(given), before.cloud.points);
  EXPECT_EQ(after.source, before.source);
  EXPECT_EQ(after.tree->size(), after.cloud.size());
  for (Index i = given; i < after.cloud.size(); ++i) {
    const Point<3> p = after.origin + after.scale * after.cloud.points.col(i);
    EXPECT_NEAR(depth(p), 0, 0.15);
    EXPECT_GT(after.cloud.normals.col(i).dot(Point<3>(p[0], p[1], 0).normalized()), 0.95);
  }
  // They cover the gap.
  const PointCloud whole = capsule();
  for (Index i = 0; i < whole.size(); ++i) {
    Index nearest = 0;
    double d2 = 0;
    after.tree->nearest((whole.points.col(i) - after.origin) / after.scale, 1, &nearest, &d2);
    EXPECT_LT(after.scale * std::sqrt(d2), 0.15);
  }
}

TEST(BridgeGaps, OfAReconstructionAreNoPointsOfItsInput) {
  const PointCloud cloud = cut_capsule(-0.4, 2.6);
  const Reconstruction result = reconstruct(cloud);
  EXPECT_EQ(result.report.points_used, cloud.size());
  ASSERT_EQ(static_cast<Index>(result.source.size()), cloud.size());
  ASSERT_EQ(result.normals.cols(), cloud.size());
  for (Index i = 0; i < cloud.size(); ++i)
    EXPECT_NEAR(result.normals.col(i).dot(cloud.normals.col(result.source[i])), 1, 1e-12);
}

TEST(BridgeGaps, DoesNotDependOnPlaceSizeAndDirection) {
  const PointCloud cloud = cut_capsule(-0.4, 2.6);
  Similarity move = rotation(0.7);
  move.scale = 1e3;
  move.shift = {1e4, 0, -5e3};
  expect_closed(polygonize(*reconstruct(move(cloud)).field), 1, 2);
}

TEST(BridgeGaps, KeepsClosedBodiesApart) {
  const PointCloud two = joined(sphere_cloud(5000), sphere_cloud(4000, 2, 1, {2.3, 0, 0}));
  EXPECT_EQ(joined_parts(two), 0);
  expect_closed(polygonize(*reconstruct(two).field), 2, 4);
}

PointCloud cloud_of(const Shape& shape) {
  return {shape.points, shape.normals, {}};
}

// Here and there a random sample has no neighbours on one side.
TEST(BridgeGaps, KeepsBodiesApartThatAreSampledAtRandom) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const PointCloud pair =
        cloud_of(join(random_sphere(4000, 2 * seed), random_sphere(4000, 2 * seed + 1, {2.3, 0, 0})));
    EXPECT_EQ(joined_parts(pair), 0) << seed;
    PointCloud shell = cloud_of(random_sphere(4000, 2 * seed + 1, Point<3>::Zero(), 0.8));
    shell.normals *= -1;
    EXPECT_EQ(joined_parts(joined(cloud_of(random_sphere(4000, 2 * seed)), shell)), 0) << seed;
  }
}

TEST(BridgeGaps, KeepsBodiesApartThatAreOpenElsewhere) {
  const auto above = [](const Point<3>& p) { return p[2] > -0.6; };  // both stand on a table
  const PointCloud two = joined(part(sphere_cloud(5000), above), part(sphere_cloud(4000, 2, 1, {2.3, 0, 0}), above));
  EXPECT_EQ(joined_parts(two), 0);
}

TEST(BridgeGaps, KeepsPartsApartThatAreFarFromEachOther) {
  EXPECT_EQ(joined_parts(part(joined(sphere_cloud(5000), sphere_cloud(4000, 2, 1, {0, 0, 7})),
                              [](const Point<3>& p) { return p[2] < 0.8 || p[2] > 6.2; })),
            0);
}

}  // namespace
}  // namespace csrbf
