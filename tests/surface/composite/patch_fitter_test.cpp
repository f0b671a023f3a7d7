#include "surface/patch_testing.hpp"

#include <Eigen/Geometry>

#include <numeric>

namespace csrbf::patch_fitter_test {
namespace {

// Distance of x to the surface of a patch of one piece.
double distance(const FittedPatch& fitted, const Point<3>& x) {
  const Eigen::MatrixX3d q = (fitted.frame().T * (x - fitted.frame().center)).transpose();
  return fitted.pieces.front().distances(q)[0];
}

// Coefficients of 1, x, y, z, xx, xy, xz, yy, yz, zz in the coordinates of the cloud.
Eigen::Matrix<double, 10, 1> quadric_in_world(const Patch& p) {
  Eigen::Matrix3d A;
  A << p.quadric[4], p.quadric[5] / 2, p.quadric[6] / 2,  //
      p.quadric[5] / 2, p.quadric[7], p.quadric[8] / 2,   //
      p.quadric[6] / 2, p.quadric[8] / 2, p.quadric[9];
  A = p.radius * p.T.transpose() * A * p.T;
  const Point<3> b = p.radius * p.T.transpose() * p.quadric.segment<3>(1);
  const Point<3> linear = b - 2 * A * p.center;
  const double constant = p.radius * p.quadric[0] - b.dot(p.center) + p.center.dot(A * p.center);
  Eigen::Matrix<double, 10, 1> q;
  q << constant, linear, A(0, 0), 2 * A(0, 1), 2 * A(0, 2), A(1, 1), 2 * A(1, 2), A(2, 2);
  return q;
}

// Samples of the plane normal . x = 0.3 in a square of side 2, with spacing h.
OrientedPoints plane_cloud(Index n, const Point<3>& normal) {
  const Point<3> u = normal.unitOrthogonal(), v = normal.cross(u);
  PointCloud cloud{Points<3>(3, n), normal.replicate(1, n), {}};
  for (Index i = 0; i < n; ++i) {
    const Eigen::Vector2d uv = 2 * quasi_random(i, 1) - Eigen::Vector2d(1, 1);
    cloud.points.col(i) = 0.3 * normal + uv[0] * u + uv[1] * v;
  }
  return oriented(cloud, 4);
}

TEST(PatchFitter, FindsTheQuadricOfASphere) {
  // Half of the sphere, so that all ten coefficients are determined well.
  const OrientedPoints cloud = oriented(sphere_cloud(2000), 4 * pi);
  Eigen::Matrix<double, 10, 1> expected;
  expected << .5, 0, 0, 0, -.5, 0, 0, -.5, 0, -.5;
  for (const Point<3>& top : {Point<3>(0, 0, 1), Point<3>(-1, 2, 0.5)}) {
    const FittedPatch fitted = fit_around(cloud, top.normalized(), quadric_only(600));
    constexpr double ridge_bias = 1e-3;  // the ridge of 1e-6 against the smallest eigenvalue of the normal matrix
    EXPECT_NEAR((quadric_in_world(fitted.frame()) - expected).norm(), 0, ridge_bias);
  }
}

TEST(PatchFitter, FindsAPlaneExactly) {
  const Point<3> normal = Point<3>(1, -2, 3).normalized();
  const OrientedPoints cloud = plane_cloud(1000, normal);
  for (const Index centers : {0, 16}) {
    CompositeOptions options;
    options.centers_per_patch = centers;
    const FittedPatch fitted = fit_around(cloud, 0.3 * normal, options);
    Eigen::Matrix<double, 10, 1> expected;
    expected << 0.3, -normal, 0, 0, 0, 0, 0, 0;  // f = 0.3 - normal . x
    constexpr double rounding = 1e-9;
    EXPECT_NEAR((quadric_in_world(fitted.frame()) - expected).norm(), 0, rounding);
    EXPECT_TRUE(fitted.pieces.front().alpha.size() == 0 || fitted.pieces.front().alpha.norm() < rounding);
    EXPECT_NEAR((fitted.frame().T.row(2).normalized().transpose() - normal).norm(), 0, rounding);
    EXPECT_NEAR((fitted.frame().T * fitted.frame().T.transpose() * std::pow(fitted.frame().radius, 2)).trace(), 3,
                rounding);
    EXPECT_GT(fitted.frame().T.determinant(), 0);
  }
}

TEST(PatchFitter, StepsToThePlaneExactlyAndToASphereToFirstOrder) {
  const Point<3> normal = Point<3>(1, -2, 3).normalized();
  const OrientedPoints plane = plane_cloud(1000, normal);
  const FittedPatch flat = fit_around(plane, 0.3 * normal, {});
  const Point<3> x = 0.35 * normal + 0.02 * normal.unitOrthogonal();
  EXPECT_NEAR((flat.step_to_surface(x) + 0.05 * normal).norm(), 0, 1e-9);

  const FittedPatch cap = fit_around(oriented(sphere_cloud(2000), 4 * pi), Point<3>::UnitZ(), quadric_only(600));
  for (const double d : {0.1, 0.01, 0.001, -0.01}) {
    const Point<3> y = (1 + d) * Point<3>(0.1, 0.2, 1).normalized();
    // The first-order distance to (1 - r^2) / 2 is (r^2 - 1) / 2r = d - d^2 / 2 + O(d^3).
    EXPECT_NEAR((y + cap.step_to_surface(y)).norm(), 1 + d * d / 2, std::abs(d * d * d) + 1e-6) << d;
  }
}

TEST(PatchFitter, PutsTheInsideWhereTheNormalsPointAway) {
  const OrientedPoints cloud = oriented(Torus().cloud(4000), Torus().area());
  for (Index i = 0; i < cloud.size(); i += 100) {
    const FittedPatch fitted = fit_around(cloud, cloud.points.col(i), {});
    const double step = 0.1 * fitted.frame().radius;
    EXPECT_NEAR(value(fitted, cloud.points.col(i) - step * cloud.normals.col(i)), step, 0.2 * step);
    EXPECT_NEAR(value(fitted, cloud.points.col(i) + step * cloud.normals.col(i)), -step, 0.2 * step);
  }
}

TEST(PatchFitter, TurnsMovesAndScalesWithTheCloud) {
  const PointCloud torus = Torus().cloud(4000);
  const OrientedPoints cloud = oriented(torus, Torus().area());
  Similarity moved, shrunk, all = rotation(2);
  moved.shift = {1e3, -1e3, 1e3};
  shrunk.scale = 1e-3;
  all.scale = 1e3;
  all.shift = {1e3, 0, 1e3};
  for (const Similarity& map : {moved, shrunk, rotation(1), all}) {
    const OrientedPoints mapped{map(cloud.points), map.R * cloud.normals, map.scale * cloud.spacing};
    for (const Index i : {7, 1234, 3999}) {
      const FittedPatch fitted = fit_around(cloud, cloud.points.col(i), {});
      const FittedPatch image = fit_around(mapped, mapped.points.col(i), {});
      const double radius = fitted.frame().radius;
      EXPECT_NEAR(image.frame().radius, map.scale * radius, 1e-9 * map.scale * radius);
      const Points<3> around = random_points(20, Box<3>{-Point<3>::Ones(), Point<3>::Ones()}, 1);
      for (Index k = 0; k < around.cols(); ++k) {
        const Point<3> x = cloud.points.col(i) + 0.4 * radius * around.col(k);
        EXPECT_NEAR(value(image, map(x)), map.scale * value(fitted, x), 1e-9 * map.scale * radius);
      }
    }
  }
}

TEST(PatchFitter, UsesNoSampleWhoseNormalIsMoreThan78DegreesAway) {
  const PointCloud torus = Torus().cloud(4000);
  const Index center = 500;
  const Point<3> normal = torus.normals.col(center), aside = normal.unitOrthogonal();
  const auto with_sheet = [&](double degrees) {
    // A second sheet through the first: every sample again, moved a little, all with one normal.
    PointCloud sheet = with_noise(torus, 0.02);
    const double angle = degrees * pi / 180;
    sheet.normals.colwise() = Point<3>(std::cos(angle) * normal + std::sin(angle) * aside);
    return joined(torus, sheet);
  };
  const double area = Torus().area();
  const KdTree<3> tree(torus.points);
  const std::vector<Index> ids = nearest(tree, torus.points.col(center), 1);
  const auto fit = [&](const PointCloud& cloud) {
    OrientedPoints samples = oriented(cloud, area);
    samples.spacing.setConstant(std::sqrt(area / 4000));
    CompositeOptions options;
    options.overlap = 40;
    const KdTree<3> all(samples.points);
    return PatchFitter(samples, all, options).fit(ids.data(), 1);
  };
  const FittedPatch alone = fit(torus), opposite = fit(with_sheet(180)), away = fit(with_sheet(80)),
                    used = fit(with_sheet(76));
  EXPECT_EQ(opposite.frame().quadric, alone.frame().quadric);
  EXPECT_EQ(opposite.pieces.front().alpha, alone.pieces.front().alpha);
  EXPECT_EQ(away.frame().quadric, alone.frame().quadric);
  EXPECT_EQ(away.pieces.front().alpha, alone.pieces.front().alpha);
  EXPECT_NE(used.frame().quadric, alone.frame().quadric);
}

TEST(PatchFitter, MakesAPatchOfOneToSevenPoints) {
  const PointCloud sphere = sphere_cloud(7);
  for (Index n = 1; n <= 7; ++n) {
    const OrientedPoints cloud{sphere.points.leftCols(n), sphere.normals.leftCols(n), Eigen::VectorXd::Ones(n)};
    const KdTree<3> tree(cloud.points);
    const CompositeOptions options;
    PatchFitter fitter(cloud, tree, options);
    std::vector<Index> all(n);
    std::iota(all.begin(), all.end(), Index{0});
    for (const std::vector<Index>& ids : {all, {n - 1}}) {
      const FittedPatch fitted = fitter.fit(ids.data(), static_cast<Index>(ids.size()));
      EXPECT_TRUE(fitted.frame().quadric.allFinite() && fitted.frame().T.allFinite() &&
                  fitted.pieces.front().alpha.allFinite());
      EXPECT_TRUE(std::isfinite(fitted.frame().radius) && fitted.frame().radius > 0);
      EXPECT_GT(fitter.areas().of(1), 0);
      EXPECT_TRUE(fitted.step_to_surface(cloud.points.col(0)).allFinite());
    }
    const FittedPatch single = fitter.fit(&all[0], 1);
    const Point<3> p = cloud.points.col(0), normal = cloud.normals.col(0);
    EXPECT_GT(value(single, p - 0.1 * normal), value(single, p + 0.1 * normal));
  }
}

TEST(PatchFitter, SurvivesNormalsThatCancelAndPointsThatCoincide) {
  OrientedPoints cloud{Points<3>::Zero(3, 10), Point<3>::UnitZ().replicate(1, 10), Eigen::VectorXd::Ones(10)};
  cloud.normals.rightCols(5) *= -1;
  const KdTree<3> tree(cloud.points);
  std::vector<Index> ids(10);
  std::iota(ids.begin(), ids.end(), Index{0});
  const FittedPatch fitted = PatchFitter(cloud, tree, {}).fit(ids.data(), 10);
  EXPECT_TRUE(fitted.frame().quadric.allFinite() && fitted.pieces.front().alpha.allFinite());
  EXPECT_GT(fitted.frame().radius, 0);
}

TEST(PatchFitter, WithCsrbfIsMoreAccurateThanAQuadric) {
  const OrientedPoints cloud = oriented(Torus().cloud(8000), Torus().area());
  CompositeOptions options;
  double error[2] = {0, 0};
  for (const Index centers : {0, 16}) {
    options.centers_per_patch = centers;
    for (Index i = 0; i < cloud.size(); i += 200) {
      const FittedPatch fitted = fit_around(cloud, cloud.points.col(i), options);
      for (Index k = 0; k < cloud.size(); ++k)
        if ((cloud.points.col(k) - fitted.frame().center).norm() < 0.7 * fitted.frame().radius)
          error[centers / 16] += fitted.step_to_surface(cloud.points.col(k)).squaredNorm();
    }
  }
  EXPECT_LT(std::sqrt(error[1]), 0.5 * std::sqrt(error[0]));
}

TEST(PatchFitter, TakesCentresFromTheCandidatesOnly) {
  const OrientedPoints cloud = oriented(Torus().cloud(4000), Torus().area());
  CompositeOptions options;
  options.leaf_size = 50;
  for (Index i = 0; i < cloud.size(); i += 10) options.centers.push_back(i);
  for (const Index at_most : {3, 100}) {
    options.centers_per_patch = at_most;
    for (const Index max_points : {100, 10000}) {
      options.max_fit_points = max_points;
      const FittedPatch fitted = fit_around(cloud, cloud.points.col(77), options);
      const Patch& p = fitted.frame();
      Index near = 0;
      for (const Index i : options.centers)
        if ((cloud.points.col(i) - p.center).norm() < p.radius &&
            cloud.normals.col(i).dot(p.T.row(2).normalized()) > 0.2)
          ++near;
      EXPECT_EQ(fitted.pieces.front().alpha.size(), std::min(near, at_most));
      EXPECT_EQ(fitted.pieces.front().centers.cols(), fitted.pieces.front().alpha.size());
      for (Index j = 0; j < fitted.pieces.front().centers.cols(); ++j) {
        const Point<3> c = p.center + p.T.inverse() * fitted.pieces.front().centers.col(j);
        double least = 1;
        for (const Index i : options.centers) least = std::min(least, (cloud.points.col(i) - c).norm());
        EXPECT_LT(least, 1e-12);
      }
    }
  }
}

TEST(PatchFitter, ChecksTheToleranceOfTheSamplesInTheInnerPartOfTheSupport) {
  OrientedPoints cloud = oriented(with_noise(Torus().cloud(4000), 0.002), Torus().area());
  const KdTree<3> tree(cloud.points);
  CompositeOptions options;
  PatchFitter fitter(cloud, tree, options);
  for (const Index i : {5, 2500}) {
    const std::vector<Index> ids = nearest(tree, cloud.points.col(i), options.leaf_size);
    const FittedPatch fitted = fitter.fit(ids.data(), options.leaf_size);
    double largest = 0;
    for (Index k = 0; k < cloud.size(); ++k) {
      Point<3> q = fitted.frame().T * (cloud.points.col(k) - fitted.frame().center);
      q[2] *= fitted.frame().flatness;
      if (q.squaredNorm() < 0.5) largest = std::max(largest, fitted.step_to_surface(cloud.points.col(k)).norm());
    }
    ASSERT_GT(largest, 0);
    options.tolerance.setConstant(cloud.size(), 1.001 * largest);
    EXPECT_TRUE(fitter.within_tolerance(fitted));
    options.tolerance.setConstant(cloud.size(), 0.999 * largest);
    EXPECT_FALSE(fitter.within_tolerance(fitted));
  }
}

TEST(PatchFitter, KnowsTheAreaOfASample) {
  const OrientedPoints cloud = plane_cloud(2500, Point<3>::UnitZ());
  const KdTree<3> tree(cloud.points);
  const CompositeOptions options;
  PatchFitter fitter(cloud, tree, options);
  const std::vector<Index> ids = nearest(tree, Point<3>(0, 0, 0.3), options.leaf_size);
  fitter.fit(ids.data(), options.leaf_size);
  EXPECT_NEAR(fitter.areas().of(cloud.spacing[ids[0]]), 4.0 / 2500,
              0.15 * 4.0 / 2500);  // some samples on the rim of some 32
}

TEST(PatchFitter, LeavesSamplesOutWithoutFittingAgain) {
  constexpr double noise = 0.002;  // a tenth of the spacing
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  OrientedPoints cloud = plane_cloud(10000, Point<3>::UnitZ());
  for (Index i = 0; i < cloud.size(); ++i) cloud.points(2, i) += noise * normal(random);
  const KdTree<3> tree(cloud.points);
  for (const Index centers : {0, 16}) {
    CompositeOptions options = quadric_only(12);
    options.centers_per_patch = centers;
    options.normal_weight = 1e-3;
    PatchFitter fitter(cloud, tree, options);
    double fitted = 0, left_out = 0, held_out = 0;
    constexpr int patches = 400;
    for (int t = 0; t < patches; ++t) {
      const Index middle = 25 * t;
      const std::vector<Index> ids = nearest(tree, cloud.points.col(middle), options.leaf_size);
      const FittedPatch patch = fitter.fit(ids.data(), static_cast<Index>(ids.size()));
      double without = 0;
      fitter.left_out_distances(patch, {&middle, 1}, &without);
      left_out += without / patches;
      fitted += distance(patch, cloud.points.col(middle)) / patches;
      // The same sample with its noise drawn again was not fitted to.
      Point<3> again = cloud.points.col(middle);
      again[2] = 0.3 + noise * normal(random);
      held_out += distance(patch, again) / patches;
    }
    EXPECT_LT(fitted, 0.95 * held_out) << centers;
    // With leverage h: sigma / sqrt(1 - h) against sigma sqrt(1 + h); h is up to about a half. Means are known to 4 %.
    EXPECT_GT(left_out, 0.9 * held_out) << centers;
    EXPECT_LT(left_out, 1.3 * held_out) << centers;
  }
}

TEST(PatchFitter, FitsOtherSettingsToSamplesFoundBefore) {
  const OrientedPoints cloud = oriented(sphere_cloud(2000), 4 * pi);
  const KdTree<3> tree(cloud.points);
  const std::vector<Index> ids = nearest(tree, Point<3>(0, 0, 1), 12);
  CompositeOptions before, after;
  after.normal_weight = 1;
  after.centers_per_patch = 5;
  PatchSamples around = PatchFitter(cloud, tree, before).around(ids.data(), std::ssize(ids));
  PatchFitter fitter(cloud, tree, after);
  const FittedPatch expected = PatchFitter(cloud, tree, after).fit(ids.data(), std::ssize(ids)),
                    fitted = fitter.fit(ids.data(), std::ssize(ids), around);
  EXPECT_EQ(fitted.frame().radius, expected.frame().radius);
  EXPECT_EQ(fitted.frame().quadric, expected.frame().quadric);
  EXPECT_EQ(fitted.pieces.front().alpha, expected.pieces.front().alpha);
}

TEST(PieceFitter, FindsTheNormalThatAPieceFollowsLeast) {
  OrientedPoints cloud = oriented(sphere_cloud(500), 4 * pi);
  const KdTree<3> tree(cloud.points);
  const std::vector<Index> ids = nearest(tree, Point<3>(0, 0, 1), 30);
  cloud.normals.col(ids[7]) = (cloud.normals.col(ids[7]) + Point<3>(0.5, 0.2, 0)).normalized();
  for (const Index centers : {0, 16})
    for (const NormalRows rows : {NormalRows::gradient, NormalRows::off_surface}) {
      CompositeOptions options;
      options.centers_per_patch = centers;
      options.normal_rows = rows;
      FittedPiece piece;
      piece.patch = PatchFitter(cloud, tree, options).around(ids.data(), std::ssize(ids)).frame;
      PieceFitter fitter;
      fitter.fit(cloud, ids, options, piece);
      const Patch& patch = piece.patch;
      double largest = 0;
      for (const Index i : ids) {
        const Eigen::MatrixX3d q = (patch.T * (cloud.points.col(i) - patch.center)).transpose();
        const Point<3> slope = piece.evaluate(q).rightCols<3>().transpose();
        largest = std::max(largest, (slope + patch.radius * (patch.T * cloud.normals.col(i))).norm());
      }
      EXPECT_GT(largest, 0.1);
      EXPECT_NEAR(fitter.largest_normal_residual(piece), largest, 1e-9);
    }
}

}  // namespace
}  // namespace csrbf::patch_fitter_test
