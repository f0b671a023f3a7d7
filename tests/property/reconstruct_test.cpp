#include "csrbf/surface/reconstruct.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/surface/estimate_normals.hpp"
#include "csrbf/surface/surface_method.hpp"

#include "csrbf/surface/baselines/method_fit.hpp"
#include "property/random_cloud.hpp"

namespace csrbf::reconstruct_test {
namespace {

constexpr Index most_points = 3000;

ReconstructOptions random_options(Random& random, bool any_method) {
  ReconstructOptions options;
  if (any_method) {
    const auto& methods = surface_methods();
    options.method = methods[random.whole(0, static_cast<int>(methods.size()) - 1)].name;
  }
  options.normals = static_cast<Normals>(random.whole(0, 2));
  options.normal_rows = static_cast<NormalRows>(random.whole(0, 1));
  if (random.one_in(3)) options.centers = random.whole(1, 500);
  if (random.one_in(3)) options.smoothing = random.one_in(2) ? 0 : random.magnitude(-6, 2);
  if (random.one_in(8) && !any_method) options.tolerance = random.magnitude(-6, -1);
  return options;
}

PolygonizeOptions random_grid(Random& random) {
  PolygonizeOptions options;
  options.method = static_cast<PolygonizeMethod>(random.whole(0, 3));
  options.resolution = random.whole(1, 48);
  options.refine = random.one_in(2);
  return options;
}

void expect_sound(const Mesh& mesh) {
  const Topology t = topology(mesh);
  EXPECT_TRUE(t.watertight());
  EXPECT_TRUE(t.manifold());
  EXPECT_EQ(t.vertices, mesh.vertices.cols());
  EXPECT_TRUE(mesh.vertices.allFinite());
  EXPECT_TRUE(mesh.normals.allFinite());
}

void expect_sound(const Reconstruction& surface) {
  const ReconstructReport& report = surface.report;
  EXPECT_TRUE(std::isfinite(report.rms_distance) && std::isfinite(report.max_distance));
  EXPECT_LE(report.p99_distance, report.max_distance);
  EXPECT_EQ(static_cast<Index>(surface.source.size()), report.points_used);
  EXPECT_EQ(surface.normals.cols(), report.points_used);
  const Box<3> bounds = surface.field->bounds();
  ASSERT_TRUE(bounds.lo.allFinite() && bounds.hi.allFinite() && !bounds.empty());
  Points<3> x(3, 4);
  // A slope of 1e9 ten sizes away from a cloud of size 1e300 is beyond the doubles, and infinity the right answer.
  const double away = bounds.extent().maxCoeff() < 1e280 ? 10 : 0;
  x << bounds.center(), bounds.lo, bounds.hi + away * bounds.extent(), Point<3>::Constant(std::nan(""));
  const Jet<3> jet = surface.field->evaluate(x, Derivatives::gradient);
  EXPECT_TRUE(jet.value.head(3).allFinite() && jet.gradient.leftCols(3).allFinite());
}

TEST(ReconstructProperties, AnyCloudBecomesAClosedManifoldOrAnError) {
  for_each_case(20, 4, [](Random& random) {
    const PointCloud cloud = random_cloud(random, most_points);
    const Reconstruction surface = reconstruct(cloud, random_options(random, false));
    expect_sound(surface);
    expect_sound(polygonize(*surface.field, random_grid(random)));
  });
}

TEST(ReconstructProperties, AnyCloudBecomesAClosedManifoldOrAnErrorByTheOtherMethods) {
  for_each_case(10, 10, [](Random& random) {
    const PointCloud cloud = random_cloud(random, 300);
    const ReconstructOptions options = random_options(random, true);
    SCOPED_TRACE(options.method);
    const Reconstruction surface = reconstruct(cloud, options);
    expect_sound(surface);
    expect_sound(polygonize(*surface.field, random_grid(random)));
  });
}

TEST(ReconstructProperties, EstimatedNormalsAreUnitOrZeroAndAreCounted) {
  for_each_case(30, 4, [](Random& random) {
    const PointCloud cloud = random_cloud(random, most_points);
    NormalOptions options;
    options.neighbors = random.one_in(2) ? 0 : random.whole(3, 40);
    options.orient = static_cast<Orient>(random.whole(0, 2));
    options.viewpoint = 3 * random.direction<3>();
    NormalReport report;
    const Points<3> normals = estimate_normals(cloud.points, options, &report);
    ASSERT_EQ(normals.cols(), cloud.size());
    Index zero = 0;
    for (Index i = 0; i < normals.cols(); ++i) {
      if (normals.col(i).isZero(0))
        ++zero;
      else
        ASSERT_NEAR(normals.col(i).norm(), 1, 1e-12);  // rounding
    }
    EXPECT_EQ(zero, report.undetermined);
  });
}

}  // namespace
}  // namespace csrbf::reconstruct_test
