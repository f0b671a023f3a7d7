#include "thesis/figure_6_10.hpp"
#include "thesis/figure_6_21.hpp"
#include "thesis/figure_6_4.hpp"
#include "thesis/figure_6_6.hpp"
#include "thesis/figure_6_8.hpp"
#include "thesis/models.hpp"

#include "surface/surface_testing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace csrbf::thesis::figure_6_test {
namespace {

TEST(Models, AreThereWithUnitNormals) {
  for (const char* name : {"bunny", "dragon", "kitten", "knot"}) {
    const auto cloud = model(name, 2000);
    if (!cloud) GTEST_SKIP() << models_file << " is not there: apt-get install libcgal-demo";
    EXPECT_GE(cloud->size(), 2000) << name;
    EXPECT_TRUE(cloud->has_normals()) << name;
    EXPECT_LT((cloud->normals.colwise().norm().array() - 1).abs().maxCoeff(), 1e-5) << name;
  }
  EXPECT_FALSE(model("unknown").has_value());
}

TEST(Models, TheVesselTreeIsOneTreeWithNormalsOutwards) {
  const PointCloud vessels = vessel_tree(3000);
  ASSERT_EQ(vessels.size(), 3000);
  const MeshedSurface mesh = meshed(with_budget(vessels, "medial-axis", 600), 64);
  EXPECT_TRUE(mesh.whole());
  EXPECT_EQ(mesh.topology.euler, 2);
}

TEST(CenterChoices, AreDistinctSamples) {
  const PointCloud torus = Torus{}.cloud(900);
  for (const CenterChoice choice : all_choices) {
    const std::vector<Index> ids = choose_centers(choice, torus.points, 120);
    EXPECT_EQ(std::set<Index>(ids.begin(), ids.end()).size(), 120U) << name_of(choice);
    EXPECT_TRUE(std::is_sorted(ids.begin(), ids.end()));
    EXPECT_LT(ids.back(), 900);
  }
}

TEST(Figure_6_6, FurthestPointsBeatRandomCentersAndMoreAreBetter) {
  const auto all = choice_errors(Torus{}.cloud(3000), {100, 400});
  ASSERT_EQ(all.size(), 8U);
  const auto error = [&](CenterChoice choice, std::size_t budget) {
    return all[4 * budget + static_cast<std::size_t>(choice)].medial.rms_taubin;
  };
  for (const CenterChoice choice : all_choices) EXPECT_LT(error(choice, 1), error(choice, 0)) << name_of(choice);
  EXPECT_LT(error(CenterChoice::furthest, 0), error(CenterChoice::random, 0));
  for (const ChoiceErrors& e : all) {
    EXPECT_LE(e.composite.mean_taubin, e.composite.rms_taubin);
    EXPECT_LT(e.composite.rms_taubin, 1e-2);
  }
}

TEST(Figure_6_8, ErrorsRiseWithTooMuchSmoothing) {
  const PointCloud clean = Torus{}.cloud(2000);
  const auto errors = smoothing_errors(clean, shaken(clean, 0.005), 200, {1e-2, 1e8});
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_LT(errors[0], 0.005);  // less than the noise
  EXPECT_LE(errors[0], 1.3 * *std::min_element(errors.begin() + 1, errors.end()));
}

TEST(Figure_6_4, RidgesOfATorusAreSamplesWithNormals) {
  // Stretched, so that it has ridges.
  PointCloud cloud = Torus{}.cloud(4000);
  cloud.points.row(2) *= 0.65;
  cloud.normals.row(2) /= 0.65;
  cloud.normals.colwise().normalize();
  const PointCloud lines = on_ridges(cloud, 72, 0.5);
  EXPECT_GT(lines.size(), 50);
  EXPECT_LT((lines.normals.colwise().norm().array() - 1).abs().maxCoeff(), 1e-9);
}

TEST(Figure_6_10, SupportsOfATorusAreItsRadiusAndNeverLargerThanToTheOwnPole) {
  const PointCloud cloud = Torus{}.cloud(3000);
  const SupportSizes sizes = support_sizes(cloud, 800);
  const double minor = Torus{}.minor / bounding_box<3>(cloud.points).diagonal();
  EXPECT_NEAR(sizes.nearest.mean(), minor, 0.05 * minor);
  EXPECT_TRUE((sizes.own.array().isNaN() || sizes.nearest.array() <= 1.000001 * sizes.own.array()).all());
}

TEST(Figure_6_21, ConditionNumbersFallWithTheWeight) {
  const std::vector<double> found = conditions(Torus{}.cloud(2000), 100, {1e-4, 1e-2, 1});
  ASSERT_EQ(found.size(), 3U);
  EXPECT_GT(found[0], found[1]);
  EXPECT_GT(found[1], found[2]);
  EXPECT_GE(found[2], 1);
}

TEST(Figures_6, DrawPictures) {
  const PointCloud cloud = Torus{}.cloud(500);
  const Mesh mesh = meshed(with_budget(cloud, "composite", 100), 24).mesh;
  const Eigen::VectorXd length = mesh.vertices.row(0).transpose().cwiseAbs();
  for (const RgbImage& image : {picture(cloud, {}), picture(mesh, {}), colored(mesh, length, 1, {})}) {
    EXPECT_GT(image.width, 0);
    EXPECT_NE(*std::min_element(image.pixels.begin(), image.pixels.end()), 255);
  }
}

}  // namespace
}  // namespace csrbf::thesis::figure_6_test
