#include "csrbf/surface/medial/medial_axis.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/combine/transformed_field.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/surface/prepare/prepare.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "surface/surface_testing.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <numeric>

namespace csrbf::medial_axis_test {
namespace {

MedialAxisFit fit(const OrientedPoints& cloud, const MedialAxisOptions& options) {
  const KdTree<3> tree(cloud.points);
  return fit_medial_axis(cloud, tree, options);
}

// Root mean square of |f| / |grad f| (Taubin's distance) at points of the true surface.
double taubin(const Field<3>& field, const Points<3>& points) {
  const Jet<3> jet = field.evaluate(points, Derivatives::gradient);
  return std::sqrt((jet.value.array() / jet.gradient.colwise().norm().transpose().array()).square().mean());
}

const Torus torus;

OrientedPoints torus_samples(Index n) {
  return oriented(torus.cloud(n), torus.area());
}

TEST(MedialAxis, ReproducesASphere) {
  constexpr double ridge = 1e-5;  // a few times that of the quadrics
  const MedialAxisFit sphere = fit(oriented(sphere_cloud(4000), 4 * pi), {.centers = 300});
  EXPECT_LT(taubin(*sphere.field, sphere_cloud(1000, 2).points), ridge);
  EXPECT_LT((sphere.scales.array() - 1).abs().maxCoeff(), 1e-3);
}

TEST(MedialAxis, HasTheScalesOfATorus) {
  const MedialAxisFit result = fit(torus_samples(10000), {.centers = 500});
  EXPECT_GT(result.scales.minCoeff(), 0.99 * torus.minor);
  EXPECT_LT(result.scales.maxCoeff(), 1.05 * torus.minor);
}

TEST(MedialAxis, ConvergesWithTheBudget) {
  const OrientedPoints cloud = torus_samples(20000);
  const Points<3> test = torus.cloud(2000, 5).points;
  double before = 0;
  for (const Index centers : {160, 640, 2560}) {
    const double error = taubin(*fit(cloud, {.centers = centers}).field, test);
    if (before > 0) {
      // Quadrics: third order in the distance of centres, which halves; less what the smoothing costs.
      EXPECT_LT(error, before / 5.5);
    }
    before = error;
  }
}

TEST(MedialAxis, IsBetterWithFarthestPointsThanWithRandomCentres) {
  const OrientedPoints cloud = torus_samples(20000);
  std::vector<Index> random(20000);
  std::iota(random.begin(), random.end(), Index{0});
  std::shuffle(random.begin(), random.end(), std::mt19937_64(1));
  random.resize(500);
  const Points<3> test = torus.cloud(2000, 5).points;
  const double farthest = taubin(*fit(cloud, {.centers = 500}).field, test);
  const double other = taubin(*fit(cloud, {.center_indices = random}).field, test);
  EXPECT_LT(1.5 * farthest, other);
}

TEST(MedialAxis, SmoothsNoiseAsTheCrossValidationFinds) {
  constexpr double noise = 0.01;
  const OrientedPoints cloud = oriented(with_noise(torus.cloud(10000), noise), torus.area());
  const Points<3> test = torus.cloud(2000, 5).points;
  const double none = taubin(*fit(cloud, {.centers = 1000, .smoothing = 0.0}).field, test);
  const MedialAxisFit chosen = fit(cloud, {.centers = 1000});
  const double automatic = taubin(*chosen.field, test);
  EXPECT_GT(chosen.smoothing, 0);
  EXPECT_LT(automatic, none);
  EXPECT_LT(automatic, 0.4 * noise);
  const double too_much = taubin(*fit(cloud, {.centers = 1000, .smoothing = 1e4}).field, test);
  EXPECT_LT(automatic, 1.1 * too_much);  // quadrics alone smooth well
}

// Noise as large as the distance between samples: f could meet them by being flat, and cells of centres overlap.
TEST(MedialAxis, ChoosesNearlyTheBestSmoothingUnderStrongNoise) {
  const Points<3> test = torus.cloud(2000, 5).points;
  struct Case {
    double noise;
    Index centers;
  };
  for (const auto& [noise, centers] : {Case{0.01, 1500}, Case{0.02, 250}, Case{0.04, 1200}}) {
    PointCloud samples = with_noise(torus.cloud(10000), noise);  // 0.3 to 1.3 % of the diagonal
    samples.normals += 0.2 * random_points(samples.size(), {Point<3>::Constant(-1.7), Point<3>::Constant(1.7)}, 8);
    samples.normals.colwise().normalize();
    const PreparedCloud cloud = prepare(samples, Normals::file);
    const auto error = [&, budget = centers](std::optional<double> smoothing) {
      const MedialAxisFit one = fit_medial_axis(cloud.cloud, *cloud.tree, {.centers = budget, .smoothing = smoothing});
      return cloud.scale * taubin(*one.field, (test.colwise() - cloud.origin) / cloud.scale);
    };
    const double automatic = error({}), best = std::min(error(0.1), error(10.0));
    EXPECT_LT(automatic, 1.2 * best) << noise << " " << centers;
    EXPECT_LT(automatic, 0.35 * noise) << noise << " " << centers;
  }
}

TEST(MedialAxis, IsTheSameForEveryNumberOfThreads) {
  const OrientedPoints cloud = torus_samples(3000);
  const Points<3> x = random_points(500, bounding_box<3>(cloud.points).inflated(0.2), 3);
  std::vector<Eigen::VectorXd> values;
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    values.push_back(fit(cloud, {.centers = 300}).field->evaluate(x).value);
  }
  set_thread_count(0);
  EXPECT_EQ(values[0], values[1]);
}

TEST(MedialAxis, RefusesOptionsOutOfRange) {
  const OrientedPoints cloud = torus_samples(100);
  const auto message = [&](const MedialAxisOptions& options) {
    return invalid_input_message([&] { (void)fit(cloud, options); });
  };
  EXPECT_NE(message({.centers = -1}).find("fit_medial_axis: centers = -1"), std::string::npos);
  EXPECT_NE(message({.smoothing = -1.0}).find("smoothing = -1"), std::string::npos);
}

TEST(MedialSupports, HoldEnoughCellsAndEverySample) {
  // A thin plate: poles are between its sheets, nearer than the neighbours.
  PointCloud plate = sphere_cloud(4000);
  plate.points.row(2) *= 0.02;
  plate.normals.row(2) /= 0.02;
  plate.normals.colwise().normalize();
  std::vector<Index> every;
  for (Index i = 0; i < plate.size(); i += 20) every.push_back(i);
  const Points<3> centers = plate.points(Eigen::all, every), normals = plate.normals(Eigen::all, every);
  const MedialSupports result = medial_supports(centers, normals, plate.points);
  EXPECT_TRUE((result.scales.array() < result.supports.array()).any());
  EXPECT_TRUE((pi * result.supports.array().square() >= 2.999 * result.areas.array()).all());
  for (Index k = 0; k < plate.size(); ++k) {
    const Eigen::RowVectorXd distance = (centers.colwise() - plate.points.col(k)).colwise().norm();
    EXPECT_GE((distance.transpose().array() < result.supports.array()).count(), 4);
  }
}

// Central differences; the steps balance truncation against the rounding of the winding number, which is in single
// precision: near the surface, where the balls decide alone.
TEST(MedialAxisField, HasTheDerivativesOfItsValues) {
  const MedialAxisFit result = fit(torus_samples(3000), {.centers = 300});
  const Field<3>& f = *result.field;
  Points<3> x = torus.cloud(100, 7).points;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> offset(-0.02, 0.02);
  for (Index i = 0; i < x.cols(); ++i) x.col(i) += Point<3>(offset(random), offset(random), offset(random));
  constexpr double h = 1e-5;
  const Jet<3> jet = f.evaluate(x, Derivatives::hessian);
  EXPECT_LT((jet.value - f.evaluate(x).value).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((jet.gradient - f.evaluate(x, Derivatives::gradient).gradient).cwiseAbs().maxCoeff(), 1e-12);
  for (int c = 0; c < 3; ++c) {
    const Point<3> step = h * Point<3>::Unit(c);
    const Jet<3> up = f.evaluate(x.colwise() + step, Derivatives::gradient);
    const Jet<3> down = f.evaluate(x.colwise() - step, Derivatives::gradient);
    const Eigen::VectorXd slope = (up.value - down.value) / (2 * h);
    EXPECT_LT((slope - jet.gradient.row(c).transpose()).cwiseAbs().maxCoeff(), 1e-6);
    for (Index i = 0; i < x.cols(); ++i) {
      const Point<3> bend = (up.gradient.col(i) - down.gradient.col(i)) / (2 * h);
      EXPECT_LT((bend - jet.hessian_matrix(i).col(c)).norm(), 1e-4 * (1 + jet.hessian_matrix(i).norm()));
    }
  }
}

TEST(MedialAxisField, HasTheRightSignEverywhere) {
  const MedialAxisFit result = fit(torus_samples(5000), {.centers = 500});
  const Points<3> x = random_points(5000, bounding_box<3>(torus.cloud(1000).points).inflated(1), 4);
  const Eigen::VectorXd f = result.field->evaluate(x).value;
  for (Index i = 0; i < x.cols(); ++i)
    if (std::abs(torus.depth(x.col(i))) > 0.01) {
      EXPECT_EQ(f[i] > 0, torus.depth(x.col(i)) > 0) << x.col(i).transpose();
    }
}

TEST(TransformedField, MovesAndScalesAField) {
  const MedialAxisFit result = fit(torus_samples(2000), {.centers = 200});
  const TransformedField placed({result.field, Point<3>(1, 2, 3), 4, 0.5, Box<3>{}});
  const Points<3> y = torus.cloud(50, 3).points * 1.02, x = (4 * y).colwise() + Point<3>(1, 2, 3);
  const Jet<3> inner = result.field->evaluate(y, Derivatives::hessian),
               outer = placed.evaluate(x, Derivatives::hessian);
  constexpr double rounding = 1e-12;
  EXPECT_LT((outer.value - 4 * inner.value).cwiseAbs().maxCoeff(), rounding);
  EXPECT_LT((outer.gradient - inner.gradient).cwiseAbs().maxCoeff(), 1e3 * rounding);
  EXPECT_LT((outer.hessian - inner.hessian / 4).cwiseAbs().maxCoeff(), 1e6 * rounding);
  EXPECT_EQ(placed.feature_size(), 0.5);
  EXPECT_LT((placed.seeds() - ((4 * result.field->seeds()).colwise() + Point<3>(1, 2, 3))).cwiseAbs().maxCoeff(),
            rounding);
}

TEST(MedialAxis, ClosesHolesThroughReconstruct) {
  PointCloud cloud = torus.cloud(8000);
  std::vector<Index> kept;
  for (Index i = 0; i < cloud.size(); ++i)
    if ((cloud.points.col(i) - Point<3>(1.35, 0, 0)).norm() > 0.3) kept.push_back(i);
  cloud = {Points<3>(cloud.points(Eigen::all, kept)), Points<3>(cloud.normals(Eigen::all, kept)), {}};
  const Reconstruction result = reconstruct(cloud, {.method = "medial-axis", .centers = 600});
  EXPECT_EQ(result.report.method, "medial-axis");
  EXPECT_EQ(result.report.centers, 600);
  EXPECT_LT(result.report.rms_distance, 1e-3);
  expect_closed(polygonize(*result.field, {.resolution = 64}), 1, 0);
}

TEST(MedialAxis, TurnsMovesAndScalesWithTheCloud) {
  Similarity similarity = rotation(0.7);
  similarity.scale = 250;
  similarity.shift = {100, -50, 7};
  const PointCloud cloud = torus.cloud(3000);
  const ReconstructOptions options{.method = "medial-axis", .centers = 3000};
  const Reconstruction one = reconstruct(cloud, options), other = reconstruct(similarity(cloud), options);
  const Points<3> x = torus.cloud(200, 9).points * 1.01;
  const Eigen::VectorXd f = one.field->evaluate(x).value, g = other.field->evaluate(similarity(x)).value;
  // All samples are centres here: which ones are picked depends on the axes. The poles move with rounding errors.
  EXPECT_LT((g / 250 - f).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(MedialAxis, IsReadBackFromItsModelBitForBit) {
  const Reconstruction result = reconstruct(torus.cloud(2000), {.method = "medial-axis", .centers = 200});
  const std::string path = (std::filesystem::temp_directory_path() / "csrbf_medial_axis_test.csrbf").string();
  write_model(path, *result.field);
  const auto read = read_model(path);
  std::filesystem::remove(path);
  const Points<3> x = random_points(1000, result.field->bounds().inflated(0.3), 5);
  EXPECT_EQ(read->evaluate(x).value, result.field->evaluate(x).value);
  EXPECT_EQ(read->feature_size(), result.field->feature_size());
  EXPECT_EQ(read->bounds().lo, result.field->bounds().lo);
}

TEST(Reconstruct, NamesTheMethodsThatItKnows) {
  const auto message = [](const ReconstructOptions& options) {
    return invalid_input_message([&] { (void)reconstruct(sphere_cloud(100), options); });
  };
  EXPECT_NE(message({.method = "magic"}).find("auto, composite, medial-axis"), std::string::npos);
  EXPECT_NE(message({.method = "medial-axis", .tolerance = 0.1}).find("only the method composite"), std::string::npos);
}

}  // namespace
}  // namespace csrbf::medial_axis_test
