#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/surface/baselines/method_fit.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "csrbf/surface/surface_method.hpp"
#include "surface/surface_testing.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

namespace csrbf::baselines_test {
namespace {

const Torus torus;

Reconstruction by(const std::string& method, const PointCloud& cloud, Index centers = 0) {
  return reconstruct(cloud, {.method = method, .centers = centers});
}

// Every method, each by its name.
class Baselines : public testing::TestWithParam<std::string> {
 protected:
  // One polynomial of degree 8 follows a sphere, but a torus only roughly.
  [[nodiscard]] static bool algebraic() {
    return std::set<std::string>{"3l", "gradient-one", "min-max", "min-var"}.count(GetParam()) > 0;
  }
};

// Centres: enough for a sphere, cheap for dense systems. A torus needs few blobs.
Index few(const std::string& method) {
  return method == "blobby" ? 12 : 300;
}

TEST_P(Baselines, FindASphereOnceClosedAndWithTheRightSign) {
  const PointCloud cloud = sphere_cloud(1500);
  const Reconstruction sphere = by(GetParam(), cloud, few(GetParam()));
  EXPECT_EQ(sphere.report.method, GetParam());
  EXPECT_LT(sphere.report.rms_distance, 5e-3);  // of the diagonal, 3.46: planes miss by spacing^2
  EXPECT_GT((*sphere.field)(Point<3>(0, 0, 0.9)), 0);
  EXPECT_LT((*sphere.field)(Point<3>(0, 0, 1.1)), 0);
  const Mesh mesh = polygonize(*sphere.field, {.resolution = 24, .seeds = cloud.points});
  expect_closed(mesh, 1, 2);
  EXPECT_LT((mesh.vertices.colwise().norm().array() - 1).abs().maxCoeff(), 0.05);
}

TEST_P(Baselines, HaveOutwardNormalsAlongMinusTheGradient) {
  const Reconstruction sphere = by(GetParam(), sphere_cloud(1500), few(GetParam()));
  const PointCloud test = sphere_cloud(100, 3);
  const Jet<3> jet = sphere.field->evaluate(test.points, Derivatives::gradient);
  for (Index i = 0; i < test.size(); ++i) EXPECT_LT(jet.gradient.col(i).normalized().dot(test.normals.col(i)), -0.95);
}

TEST_P(Baselines, AreFiniteWhereNormalsCancelAndSurviveNaN) {
  PointCloud corners{Points<3>(3, 9), Points<3>(3, 9), {}};
  for (int i = 0; i < 8; ++i) corners.points.col(i) << i % 2, i / 2 % 2, i / 4;
  corners.points.col(8).setConstant(0.5);
  for (int i = 0; i < 9; ++i) corners.normals.col(i) = (i % 2 == 0 ? 1 : -1) * Point<3>::UnitX();
  for (const Normals source : {Normals::file, Normals::estimate}) {
    std::shared_ptr<const Field<3>> field;
    try {
      field = reconstruct(corners, {.method = GetParam(), .normals = source}).field;
    } catch (const SolverFailure&) {
      continue;
    }
    EXPECT_TRUE(field->evaluate(corners.points, Derivatives::gradient).value.allFinite());
    (void)(*field)(Point<3>::Constant(std::numeric_limits<double>::quiet_NaN()));
  }
}

TEST_P(Baselines, HaveTheDerivativesOfTheirValues) {
  if (GetParam() == "hoppe") GTEST_SKIP() << "its tangent planes do not meet";
  const Reconstruction surface = by(GetParam(), torus.cloud(1500), few(GetParam()));
  const Points<3> x = 1.003 * torus.cloud(20, 3).points;
  constexpr double h = 1e-5;
  const Jet<3> jet = surface.field->evaluate(x, Derivatives::gradient);
  for (int c = 0; c < 3; ++c) {
    const Point<3> step = h * Point<3>::Unit(c);
    const Eigen::VectorXd slope =
        (surface.field->evaluate(x.colwise() + step).value - surface.field->evaluate(x.colwise() - step).value) /
        (2 * h);
    // Moving neighbourhoods have kinks where the neighbours change.
    const Eigen::ArrayXd error = (slope - jet.gradient.row(c).transpose()).cwiseAbs();
    EXPECT_LE((error > 1e-4).count(), 2) << error.transpose();
  }
}

TEST_P(Baselines, MoveAndScaleWithTheCloud) {
  const PointCloud cloud = sphere_cloud(600);
  Similarity similarity;
  similarity.scale = 100;
  similarity.shift = {3, -40, 7};
  const Reconstruction one = by(GetParam(), cloud, few(GetParam())),
                       other = by(GetParam(), similarity(cloud), few(GetParam()));
  const Points<3> x = 1.02 * sphere_cloud(50, 5).points;
  const Eigen::VectorXd f = one.field->evaluate(x).value, g = other.field->evaluate(similarity(x)).value;
  EXPECT_LT((g / 100 - f).cwiseAbs().maxCoeff(), 1e-4);
}

TEST_P(Baselines, AreReadBackFromTheirModelsBitForBit) {
  const Reconstruction surface = by(GetParam(), torus.cloud(600), few(GetParam()) / 3);
  const std::string path =
      (std::filesystem::temp_directory_path() / ("csrbf_baselines_test_" + GetParam() + ".csrbf")).string();
  if (!find_surface_method(GetParam())->has_model) {
    EXPECT_NE(invalid_input_message([&] { write_model(path, *surface.field); }).find("no file form"),
              std::string::npos);
    return;
  }
  write_model(path, *surface.field);
  const auto read = read_model(path);
  std::filesystem::remove(path);
  const Points<3> x = random_points(200, surface.field->bounds().inflated(0.1), 5);
  EXPECT_EQ(read->evaluate(x).value, surface.field->evaluate(x).value);
}

TEST_P(Baselines, FollowATorusAsFarAsTheyCan) {
  const Reconstruction surface = by(GetParam(), torus.cloud(4000), 2 * few(GetParam()));
  EXPECT_LT(surface.report.rms_distance, algebraic() ? 2e-2 : 5e-3);
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const SurfaceMethod& method : surface_methods()) all.emplace_back(method.name);
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, Baselines, testing::ValuesIn(names()), [](const auto& instance) {
  std::string name = instance.param;
  std::erase(name, '-');
  return name;
});

TEST(SurfaceMethods, HaveDifferentNamesAndSayWhatTheyAre) {
  std::set<std::string> seen = {"auto", "composite"};
  for (const SurfaceMethod& method : surface_methods()) {
    EXPECT_TRUE(seen.insert(method.name).second) << method.name;
    EXPECT_FALSE(std::string(method.what).empty());
    EXPECT_EQ(find_surface_method(method.name), &method);
  }
  EXPECT_EQ(find_surface_method("auto"), nullptr);
}

TEST(BlobbyModel, IsOneBlobForASphere) {
  const Reconstruction sphere = by("blobby", sphere_cloud(2000), 50);
  EXPECT_EQ(sphere.report.centers, 1);
  EXPECT_LT(sphere.report.rms_distance, 1e-4);  // the shrinking term weighs 1e-5
}

TEST(BlobbyModel, SeparatesTwoBalls) {
  const PointCloud cloud = joined(sphere_cloud(1000), sphere_cloud(1000, 3, 0.6, {2.5, 0, 0}));
  const Reconstruction balls = by("blobby", cloud, 20);
  EXPECT_LE(balls.report.centers, 20);
  EXPECT_LT(balls.report.rms_distance, 5e-3);  // each blob sees the tail of the others
  expect_closed(polygonize(*balls.field, {.resolution = 32}), 2, 4);
}

TEST(BlobbyModel, ComesCloserWithMoreBlobs) {
  const PointCloud cloud = torus.cloud(1000);
  double before = std::numeric_limits<double>::infinity();
  for (const Index blobs : {2, 6, 12, 24}) {
    const double error = by("blobby", cloud, blobs).report.rms_distance;
    EXPECT_LT(error, 0.7 * before) << blobs;
    before = error;
  }
  EXPECT_LT(before, 1e-3);
}

TEST(AlgebraicFits, ReproduceASphere) {
  for (const char* name : {"3l", "gradient-one", "min-max", "min-var"})
    EXPECT_LT(by(name, sphere_cloud(2000)).report.rms_distance, 1e-3) << name;
}

TEST(Interpolants, PassThroughTheirCentres) {
  for (const char* name : {"turk-obrien", "savchenko", "morse", "tobor", "multilevel"})
    EXPECT_LT(by(name, torus.cloud(500), 500).report.max_distance, name == std::string("multilevel") ? 2e-2 : 1e-6)
        << name;
}

}  // namespace
}  // namespace csrbf::baselines_test
