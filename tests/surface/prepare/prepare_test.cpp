#include "csrbf/surface/prepare/prepare.hpp"

#include "csrbf/core/parallel.hpp"
#include "surface/prepare_testing.hpp"

namespace csrbf::prepare_test {
namespace {

TEST(Prepare, BringsTheCloudToUnitCoordinatesInMortonOrder) {
  const PointCloud input = sphere_cloud(3000, 1, 5, {10, -20, 30});
  const PreparedCloud prepared = prepare(input, Normals::automatic);
  EXPECT_TRUE(prepared.warnings.empty());
  EXPECT_EQ(prepared.cloud.size(), 3000);
  expect_points_of_the_input(prepared, input);
  const Box<3> box = bounding_box<3>(prepared.cloud.points);
  EXPECT_NEAR(box.diagonal(), 1, rounding);
  EXPECT_NEAR(box.center().norm(), 0, rounding);
  EXPECT_NEAR(prepared.scale, bounding_box<3>(input.points).diagonal(), rounding * prepared.scale);
  // Neighbours in the order are neighbours in space: in random order they would be 0.38 apart, in the mean.
  const Index n = prepared.cloud.size();
  const Points<3> steps = prepared.cloud.points.rightCols(n - 1) - prepared.cloud.points.leftCols(n - 1);
  EXPECT_LT(steps.colwise().norm().mean(), 0.06);
}

TEST(Prepare, KnowsTheSpacing) {
  const PreparedCloud prepared = prepare(sphere_cloud(5000), Normals::automatic);
  const double area = 4 * pi / (prepared.scale * prepared.scale);
  EXPECT_NEAR(prepared.cloud.spacing.squaredNorm(), area, 0.2 * area);
  const double spacing = std::sqrt(area / 5000);
  EXPECT_GT(prepared.cloud.spacing.minCoeff(), 0.6 * spacing);
  EXPECT_LT(prepared.cloud.spacing.maxCoeff(), 1.6 * spacing);
}

TEST(Prepare, CountsOnlyTheOwnSideOfAThinSlabForTheSpacing) {
  // Two squares back to back, much closer than their samples.
  PointCloud slab{Points<3>(3, 4000), Points<3>(3, 4000), {}};
  for (Index i = 0; i < 4000; ++i) {
    const double side = i % 2 == 0 ? 1 : -1;
    slab.points.col(i) << quasi_random(i, 1), side * 1e-3;
    slab.normals.col(i) << 0, 0, side;
  }
  const PreparedCloud prepared = prepare(slab, Normals::file);
  const double spacing = std::sqrt(1.0 / 2000) / prepared.scale;
  std::vector<double> sorted(prepared.cloud.spacing.begin(), prepared.cloud.spacing.end());
  std::nth_element(sorted.begin(), sorted.begin() + 2000, sorted.end());
  EXPECT_NEAR(sorted[2000], spacing, 0.25 * spacing);
}

TEST(Prepare, DropsPointsThatAreNotFinite) {
  PointCloud input = sphere_cloud(1000);
  input.points(0, 5) = nan;
  input.points(1, 17) = infinity;
  input.points(2, 999) = -infinity;
  const PreparedCloud prepared = prepare(input, Normals::automatic);
  EXPECT_EQ(prepared.cloud.size(), 997);
  EXPECT_TRUE(warns(prepared, "3 points with NaN or infinite coordinates dropped"));
  expect_points_of_the_input(prepared, input);
}

TEST(Prepare, MergesDuplicatesAndTheirNormals) {
  const PointCloud sphere = sphere_cloud(1000);
  PointCloud input = joined(sphere, sphere);
  input.points.rightCols(1000) = sphere.points.rowwise().reverse();
  input.normals.rightCols(1000) = sphere.normals.rowwise().reverse();
  input.points(0, 0) = 0.0;
  input.points(0, 1999) = -0.0;
  input.normals.col(1) = Point<3>(1, 0, 0);
  input.normals.col(1998) = Point<3>(0, 1, 0);
  const PreparedCloud prepared = prepare(input, Normals::file);
  EXPECT_EQ(prepared.cloud.size(), 1000);
  EXPECT_TRUE(warns(prepared, "1000 duplicate points merged"));
  expect_points_of_the_input(prepared, input);
  for (std::size_t i = 0; i < prepared.source.size(); ++i) {
    EXPECT_LT(prepared.source[i], 1000);  // the first of each group
    if (prepared.source[i] == 1) {
      EXPECT_NEAR((prepared.cloud.normals.col(static_cast<Index>(i)) - Point<3>(1, 1, 0).normalized()).norm(), 0,
                  rounding);
    }
  }
}

TEST(Prepare, DropsAStrayPointHoweverFarAway) {
  for (const double far : {1e8, 1e20, 3.4028234663852886e38}) {  // some programs write the last for a missing value
    PointCloud input = sphere_cloud(1000);
    input.points.col(500).setConstant(far);
    const PreparedCloud prepared = prepare(input, Normals::automatic);
    EXPECT_EQ(prepared.cloud.size(), 999) << far;
    EXPECT_TRUE(warns(prepared, "1 stray points dropped")) << far;
    expect_points_of_the_input(prepared, input);
  }
}

TEST(Prepare, LeavesOutPointsThatMarkMissingValues) {
  for (const double mark : {-9999.0, 1e20}) {
    PointCloud input = sphere_cloud(1000);
    for (Index i = 0; i < 1000; i += 30) input.points(2, i) = mark;
    const PreparedCloud prepared = prepare(input, Normals::automatic);
    EXPECT_EQ(prepared.cloud.size(), 966) << mark;
    EXPECT_TRUE(warns(prepared, "34 points left out whose z is ")) << mark;
    expect_points_of_the_input(prepared, input);
  }
}

// A plate far below a ball, at another height than such marks have.
TEST(Prepare, LeavesPlatesFarAway) {
  PointCloud input = sphere_cloud(1000);
  for (Index i = 0; i < 1000; i += 3) {
    input.points(2, i) = -99;
    input.normals.col(i) = Point<3>::UnitZ();
  }
  EXPECT_FALSE(warns(prepare(input, Normals::automatic), "points left out whose"));
}

TEST(Prepare, LeavesOutFewScatteredPointsAndHardlyAnyOthers) {
  const Torus torus;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const PointCloud good = torus.cloud(10000, seed);
    const double spacing = std::sqrt(torus.area() / 10000);
    PointCloud strays{random_points(100, bounding_box<3>(good.points), seed), Points<3>::Zero(3, 100), {}};
    strays.normals.row(0).setOnes();
    const PointCloud input = joined(strays, good);
    const PreparedCloud prepared = prepare(input, Normals::automatic);
    expect_points_of_the_input(prepared, input);
    EXPECT_TRUE(warns(prepared, "stray points dropped") ||
                warns(prepared, "points scattered around the surface left out"));
    Index far = 0, far_kept = 0, good_kept = 0;
    for (Index i = 0; i < 100; ++i) far += std::abs(torus.depth(input.points.col(i))) > 6 * spacing ? 1 : 0;
    for (const Index i : prepared.source) {
      good_kept += i >= 100 ? 1 : 0;
      far_kept += i < 100 && std::abs(torus.depth(input.points.col(i))) > 6 * spacing ? 1 : 0;
    }
    EXPECT_GT(far, 20);
    EXPECT_LE(10 * far_kept, far);
    EXPECT_GE(good_kept, 10000 - 5);
  }
}

TEST(Prepare, FarStrayPointsDoNotChangeTheUnitCoordinatesOfTheRest) {
  const PointCloud good = sphere_cloud(1000);
  const PreparedCloud expected = prepare(good, Normals::automatic);
  for (const double far : {1e6, 1e300}) {
    const PointCloud input = joined(good, {far * Points<3>::Identity(3, 2), Points<3>::Identity(3, 2), {}});
    const PreparedCloud prepared = prepare(input, Normals::automatic);
    EXPECT_TRUE(warns(prepared, "2 stray points dropped"));
    EXPECT_EQ(prepared.scale, expected.scale);
    EXPECT_EQ(prepared.source, expected.source);
    EXPECT_EQ(prepared.cloud.points, expected.cloud.points);
    EXPECT_EQ(prepared.cloud.spacing, expected.cloud.spacing);
  }
}

TEST(Prepare, CountsWhatIsLeftOutInTheRegionOnly) {
  // Far from a tile its points are sparse on purpose; here two, and a point of the tile, are there twice.
  PointCloud input = joined(sphere_cloud(3000), sphere_cloud(8, 2, 20));
  input = joined(input, sphere_cloud(2, 2, 20));
  input = joined(input, sphere_cloud(1));
  const PreparedCloud whole = prepare(input, Normals::automatic);
  EXPECT_TRUE(warns(whole, "8 stray points dropped"));
  EXPECT_TRUE(warns(whole, "3 duplicate points merged"));
  const Box<3> tile{Point<3>::Constant(-1.5), Point<3>::Constant(1.5)};
  const PreparedCloud prepared = prepare(input, Normals::automatic, {}, tile);
  EXPECT_EQ(prepared.cloud.size(), 3000);
  EXPECT_FALSE(warns(prepared, "stray"));
  EXPECT_TRUE(warns(prepared, "1 duplicate points merged"));
}

TEST(Prepare, KeepsASparseObjectBesideADenseOne) {
  // 400 samples of a sphere ten times as sparse in length as the other one are no stray points.
  const PointCloud input = joined(sphere_cloud(20000), sphere_cloud(400, 2, 1.5, {5, 0, 0}));
  EXPECT_EQ(prepare(input, Normals::automatic).cloud.size(), 20400);
}

TEST(Prepare, KeepsASparseObjectOfFewSamplesButNoScatteredPoints) {
  const PointCloud dense = sphere_cloud(20000);
  for (unsigned seed = 1; seed <= 3; ++seed) {
    EXPECT_EQ(prepare(joined(dense, sphere_cloud(80, seed, 1, {4, 0, 0})), Normals::automatic).cloud.size(), 20080);
    const PointCloud scattered{random_points(80, {Point<3>(3, -1, -1), Point<3>(5, 1, 1)}, seed),
                               random_points(80, {Point<3>(-1, -1, -1), Point<3>(1, 1, 1)}, seed + 10),
                               {}};
    EXPECT_LT(prepare(joined(dense, scattered), Normals::automatic).cloud.size(), 20010);
    EXPECT_EQ(prepare(joined(dense, sphere_cloud(40, seed, 1, {4, 0, 0})), Normals::automatic).cloud.size(), 20000);
    PointCloud line = scattered;
    line.points.row(0) *= 5;
    line.points.bottomRows(2) *= .05;
    EXPECT_EQ(prepare(joined(dense, line), Normals::automatic).cloud.size(), 20000);
  }
}

TEST(Prepare, KeepsPiecesOfASparsePart) {
  // As sparse as a sphere that is a body with few samples; without it they are stray points, as above.
  const PointCloud cloud = joined(sphere_cloud(10000), sphere_cloud(400, 2, 1.5, {5, 0, 0}));
  const auto kept = [&](const PointCloud& others) {
    return prepare(joined(cloud, others), Normals::automatic).cloud.size() - cloud.size();
  };
  for (unsigned seed = 1; seed <= 2; ++seed) {
    EXPECT_EQ(kept(sphere_cloud(40, seed, 0.5, {5, 2.45, 0})), 40);
    EXPECT_EQ(kept(sphere_cloud(40, seed, 0.5, {0, 4, 0})), 0);     // far from that part
    EXPECT_LT(kept(sphere_cloud(40, seed, 1.5, {5, 3.4, 0})), 10);  // sparser
    PointCloud scattered{random_points(40, {Point<3>(4.5, 2.2, -0.5), Point<3>(5.5, 3.2, 0.5)}, seed),
                         random_points(40, {Point<3>(-1, -1, -1), Point<3>(1, 1, 1)}, seed + 10),
                         {}};
    EXPECT_LT(kept(scattered), 10);
    scattered.points.row(0) = 5 + 5 * (scattered.points.row(0).array() - 5);  // along a line
    scattered.points.row(1) = 2.2 + 0.05 * (scattered.points.row(1).array() - 2.2);
    scattered.points.row(2) *= 0.05;
    EXPECT_EQ(kept(scattered), 0);
  }
}

TEST(Prepare, KeepsTheSparseHalfOfAThinFrame) {
  // Where the samples are as far apart as the frame is thick, they look like a cloud.
  const Torus torus{1, 0.06};
  const PointCloud dense = torus.cloud(20000, 1);
  std::vector<Index> kept;
  for (Index i = 0; i < dense.size(); ++i)
    if (dense.points(0, i) < 0 || i % 50 == 0) kept.push_back(i);
  const PointCloud input{dense.points(Eigen::all, kept), dense.normals(Eigen::all, kept), {}};
  EXPECT_GT(static_cast<double>(prepare(input, Normals::automatic).cloud.size()),
            0.998 * static_cast<double>(input.size()));
}

TEST(Prepare, KeepsSparseTubesByTheirNormals) {
  // Samples as far apart as the tube is thick look like a cloud, but not with their normals.
  const Torus tube{1, 0.25};
  const PointCloud dense = sphere_cloud(20000, 1, 1, {4, 0, 0}), sparse = tube.cloud(80, 1);
  EXPECT_EQ(prepare(joined(dense, sparse), Normals::automatic).cloud.size(), 20080);
  PointCloud others = sparse;
  others.normals = random_points(80, {Point<3>(-1, -1, -1), Point<3>(1, 1, 1)}, 2);
  EXPECT_LT(prepare(joined(dense, others), Normals::automatic).cloud.size(), 20010);
}

TEST(Prepare, KeepsSparseLegsOfADenseBody) {
  // They leave most of the box empty, as points inside of bodies do, but are beside the body.
  PointCloud input = without_normals(sphere_cloud(20000));
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5}) {
      Points<3> leg = random_points(150, Box<3>{{0, 0, -3}, {2 * pi, 0, -1}}, x < y ? 1 : 2);
      for (Index i = 0; i < leg.cols(); ++i) {
        const double angle = leg(0, i);
        leg.col(i).head(2) << x + 0.06 * std::cos(angle), y + 0.06 * std::sin(angle);
      }
      input = joined(input, {leg, Points<3>(3, 0), {}});
    }
  EXPECT_EQ(prepare(input, Normals::automatic).cloud.size(), input.size());
}

TEST(Prepare, LeavesOutClutter) {
  const Torus torus;
  const PointCloud good = torus.cloud(10000, 1);
  const PointCloud input = joined(good, {random_points(2000, bounding_box<3>(good.points), 2), Points<3>(3, 0), {}});
  const PreparedCloud prepared = prepare(without_normals(input), Normals::automatic);
  EXPECT_TRUE(warns(prepared, "points scattered around the surface left out"));
  EXPECT_NEAR(static_cast<double>(prepared.cloud.size()), 10000, 300);
}

TEST(Prepare, LeavesOutPointsInside) {
  // Two balls leave most of the box empty.
  const PointCloud good = without_normals(joined(sphere_cloud(5000), sphere_cloud(5000, 2, 1, {4, 0, 0})));
  Points<3> inside = random_points(600, Box<3>{Point<3>::Constant(-0.55), Point<3>::Constant(0.55)}, 3);
  inside.row(0).tail(300).array() += 4;
  const PreparedCloud prepared = prepare(joined(good, {inside, Points<3>(3, 0), {}}), Normals::automatic);
  EXPECT_TRUE(warns(prepared, "points scattered around the surface left out"));
  EXPECT_NEAR(static_cast<double>(prepared.cloud.size()), 10000, 60);
}

TEST(Prepare, LeavesOutSmallClustersThatFillAVolume) {
  const PointCloud good = without_normals(sphere_cloud(5000));
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Points<3> cluster(3, 80);
  for (double& x : cluster.reshaped()) x = 0.1 * normal(random);
  cluster.row(0).array() += 2;
  const PreparedCloud prepared = prepare(joined(good, {cluster, Points<3>(3, 0), {}}), Normals::automatic);
  EXPECT_TRUE(warns(prepared, "points dropped that fill volumes away from the surface"));
  EXPECT_NEAR(static_cast<double>(prepared.cloud.size()), 5000, 5);
  const PointCloud other = Torus{0.12, 0.04}.cloud(80, 1);
  for (const Points<3>& small : {sphere_cloud(80, 2, 0.12).points, other.points}) {
    const Points<3> aside = small.colwise() + Point<3>(2, 0, 0);
    const PreparedCloud both = prepare(joined(good, {aside, Points<3>(3, 0), {}}), Normals::automatic);
    EXPECT_EQ(both.cloud.size(), 5080);
  }
}

TEST(Prepare, DoesNotDependOnTheUnitOrTheThreads) {
  const PointCloud input = without_normals(sphere_cloud(2000));
  const PreparedCloud expected = prepare(input, Normals::automatic);
  for (const double scale : {1e-30, 1e30, 1e-300, 1e300}) {
    const PreparedCloud prepared = prepare({scale * input.points, input.normals, {}}, Normals::automatic);
    EXPECT_NEAR(prepared.scale / scale, expected.scale, 1e-12);
    EXPECT_EQ(prepared.source, expected.source);
    EXPECT_NEAR((prepared.cloud.points - expected.cloud.points).norm(), 0, 1e-12);
    EXPECT_NEAR((prepared.cloud.normals - expected.cloud.normals).norm(), 0, 1e-9);
    EXPECT_NEAR((prepared.cloud.spacing - expected.cloud.spacing).norm(), 0, 1e-6);  // squared distances are floats
  }
  set_thread_count(1);
  const PreparedCloud serial = prepare(input, Normals::automatic);
  set_thread_count(0);
  EXPECT_EQ(serial.source, expected.source);
  EXPECT_EQ(serial.cloud.points, expected.cloud.points);
  EXPECT_EQ(serial.cloud.normals, expected.cloud.normals);
  EXPECT_EQ(serial.cloud.spacing, expected.cloud.spacing);
}

TEST(Prepare, MakesDoWithFourPoints) {
  Points<3> corners(3, 4);
  corners << 0, 1, 0, 0,  //
      0, 0, 1, 0,         //
      0, 0, 0, 1;
  const PreparedCloud prepared = prepare({corners, Points<3>(3, 0), {}}, Normals::automatic);
  EXPECT_EQ(prepared.cloud.size(), 4);
  EXPECT_TRUE(prepared.cloud.normals.allFinite());
  EXPECT_GT(prepared.cloud.spacing.minCoeff(), 0);
}

TEST(Prepare, RejectsCloudsThatHoldNoSurface) {
  const auto message = [](const Points<3>& points) {
    return invalid_input_message([&] { prepare({points, Points<3>(3, 0), {}}, Normals::automatic); });
  };
  const std::string too_few = "too few distinct finite points; at least 4 are needed";
  EXPECT_EQ(message(Points<3>(3, 0)), "reconstruct: points = 0: " + too_few);
  EXPECT_EQ(message(sphere_cloud(3).points), "reconstruct: points = 3: " + too_few);
  EXPECT_EQ(message(Points<3>::Constant(3, 50, 0.1)), "reconstruct: points = 1: " + too_few);
  EXPECT_EQ(message(Points<3>::Constant(3, 50, nan)), "reconstruct: points = 0: " + too_few);
  const Points<3> line = Point<3>(1, 2, -1) * Eigen::RowVectorXd::LinSpaced(100, -1, 1);
  EXPECT_NE(message(line).find("reconstruct: points: all lie on one line"), std::string::npos);
  EXPECT_NE(message(1e30 * line).find("reconstruct: points: all lie on one line"), std::string::npos);
}

TEST(Prepare, RejectsNormalsThatAreNotThere) {
  PointCloud cloud = without_normals(sphere_cloud(100));
  EXPECT_EQ(invalid_input_message([&] { prepare(cloud, Normals::file); }),
            "reconstruct: normals = file: the input has no normals; use estimate or auto");
  cloud.normals.setOnes(3, 99);
  EXPECT_EQ(invalid_input_message([&] { prepare(cloud, Normals::automatic); }),
            "reconstruct: normals = 99: must be one per point, or none");
}

TEST(Prepare, ReportsProgressAndCanBeCancelled) {
  const PointCloud cloud = without_normals(sphere_cloud(1000));
  Index calls = 0;
  prepare(cloud, Normals::automatic, [&](std::string_view, double fraction) {
    EXPECT_GE(fraction, 0);
    EXPECT_LE(fraction, 1);
    ++calls;
    return true;
  });
  EXPECT_GT(calls, 3);
  for (Index stop = 1; stop <= calls; ++stop) {
    Index left = stop;
    EXPECT_THROW(prepare(cloud, Normals::automatic, [&](std::string_view, double) { return --left > 0; }), Cancelled);
  }
}

}  // namespace
}  // namespace csrbf::prepare_test
