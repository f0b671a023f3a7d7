#include "csrbf/surface/prepare/find_normals.hpp"
#include "csrbf/surface/prepare/prepare.hpp"

#include "surface/oriented_shapes.hpp"
#include "surface/prepare_testing.hpp"

#include <Eigen/Eigenvalues>

#include <array>

namespace csrbf::prepare_normals_test {
namespace {

TEST(PrepareNormals, CorrectsNormalsWithErrors) {
  PointCloud input = sphere_cloud(5000);
  const PointCloud exact = input;
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal(0, 0.5);
  for (Index i = 0; i < input.size(); ++i)
    input.normals.col(i) += Point<3>(normal(random), normal(random), normal(random));
  const PreparedCloud prepared = prepare(input, Normals::automatic);
  EXPECT_EQ(prepared.normals, NormalSource::corrected);
  EXPECT_TRUE(warns(prepared, "degrees: corrected by the positions and by each other"));
  EXPECT_GT(outward(prepared, exact), 0.99);
  EXPECT_EQ(prepare(input, Normals::file).normals, NormalSource::file);
}

TEST(PrepareNormals, TakesNormalsFromTheFile) {
  PointCloud input = sphere_cloud(1000);
  input.normals *= 3;
  for (const Normals source : {Normals::file, Normals::automatic}) {
    const PreparedCloud prepared = prepare(input, source);
    EXPECT_EQ(prepared.normals, NormalSource::file);
    EXPECT_NEAR(outward(prepared, input), 1, rounding);
    EXPECT_TRUE(prepared.warnings.empty());
  }
}

TEST(PrepareNormals, EstimatesNormalsWhenToldOrWhenThereAreNone) {
  PointCloud input = sphere_cloud(2000);
  input.normals *= -1;
  const PreparedCloud told = prepare(input, Normals::estimate);
  const PreparedCloud none = prepare(without_normals(input), Normals::automatic);
  for (const PreparedCloud* prepared : {&told, &none}) {
    EXPECT_EQ(prepared->normals, NormalSource::estimated);
    EXPECT_GT(outward(*prepared, input), 0.99);
  }
}

TEST(PrepareNormals, ReorientsALargeCloudWithAFlippedPatch) {
  constexpr Index large = 120'000;  // some of the points decide whether to turn the others
  PointCloud input = sphere_cloud(large);
  for (Index i = 0; i < large; ++i)
    if (input.points(2, i) > 0.5) input.normals.col(i) *= -1;
  const PreparedCloud prepared = prepare(input, Normals::automatic);
  EXPECT_EQ(prepared.normals, NormalSource::reoriented);
  EXPECT_GT(outward(prepared, input), 0.99);
}

TEST(PrepareNormals, ReorientsNormalsThatContradictEachOther) {
  for (const unsigned one_in : {4U, 2U}) {  // one in two: signs that say nothing, as of eigenvectors
    PointCloud input = sphere_cloud(2000);
    std::mt19937_64 random(4);
    for (Index i = 0; i < 2000; ++i)
      if (random() % one_in == 0) input.normals.col(i) *= -1;
    const PreparedCloud prepared = prepare(input, Normals::automatic);
    EXPECT_EQ(prepared.normals, NormalSource::reoriented);
    EXPECT_TRUE(warns(prepared, "contradict each other: re-oriented"));
    EXPECT_NEAR(outward(prepared, input), 1, rounding);
    const PreparedCloud as_given = prepare(input, Normals::file);
    EXPECT_EQ(as_given.normals, NormalSource::file);
    EXPECT_LT(outward(as_given, input), 0.6);
  }
}

// Sheets so close to each other have defects even if all signs are right.
TEST(PrepareNormals, ReorientsThinWallsWithFlippedBlocks) {
  for (const double thickness : {2.3, 2.6}) {
    const Shape bowl = random_bowl(10'000, thickness, 1);
    PointCloud input;
    input.points = bowl.points;
    input.normals = bowl.normals;
    std::mt19937_64 random(3);
    std::array<bool, 1000> flip{};
    for (bool& block : flip) block = random() % 10 < 3;
    for (Index i = 0; i < input.size(); ++i) {
      const Eigen::Array3i block = (5 * (input.points.col(i).array() + 1).max(0).min(1.99)).cast<int>();
      if (flip[100 * block[0] + 10 * block[1] + block[2]]) input.normals.col(i) *= -1;
    }
    const PreparedCloud prepared = prepare(input, Normals::automatic);
    EXPECT_EQ(prepared.normals, NormalSource::reoriented) << thickness;
    EXPECT_GT(outward_share(prepared.cloud.normals, bowl.normals(Eigen::all, prepared.source)), 0.99) << thickness;
  }
}

// The two sheets of a plate look like one rough sheet, whose normals contradict each other.
TEST(PrepareNormals, KeepsThoseOfAThinPlateInNoise) {
  constexpr double spacing = 0.03;
  PointCloud input;
  const Shape plate = random_box({0.75, 0.75, 0.5 * spacing}, spacing, 5);
  input.points = plate.points;
  input.normals = plate.normals;
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal(0, 0.2 * spacing);
  for (double& x : input.points.reshaped()) x += normal(random);
  EXPECT_EQ(prepare(input, Normals::automatic).normals, NormalSource::file);
}

// Evenly spread over the surface of an axis-aligned box.
PointCloud box_cloud(const Point<3>& lo, const Point<3>& hi, Index per_face) {
  PointCloud cloud{Points<3>(3, 6 * per_face), Points<3>::Zero(3, 6 * per_face), {}};
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const bool upper = face % 2 == 1;
    for (Index k = 0; k < per_face; ++k) {
      const Eigen::Vector2d uv = quasi_random(k, static_cast<unsigned>(face) + 1);
      Point<3> t;
      t[axis] = upper ? 1 : 0;
      t[(axis + 1) % 3] = uv[0];
      t[(axis + 2) % 3] = uv[1];
      cloud.points.col(face * per_face + k) = lo + t.cwiseProduct(hi - lo);
      cloud.normals(axis, face * per_face + k) = upper ? 1 : -1;
    }
  }
  return cloud;
}

TEST(PrepareNormals, EstimatesNormalsOfPlanesAgain) {
  const PointCloud exact = sphere_cloud(4000);
  PointCloud input = with_noise(exact, 0.03);
  const KdTree<3> tree(input.points);
  std::vector<Index> ids(10);
  std::vector<double> squared(10);
  for (Index i = 0; i < input.size(); ++i) {
    tree.nearest(input.points.col(i), 10, ids.data(), squared.data());
    Points<3> near = input.points(Eigen::all, ids);
    near.colwise() -= near.rowwise().mean().eval();
    const Point<3> n = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(near * near.transpose()).eigenvectors().col(0);
    input.normals.col(i) = n.dot(exact.normals.col(i)) < 0 ? Point<3>(-n) : n;
  }
  const PreparedCloud prepared = prepare(input, Normals::automatic);
  EXPECT_EQ(prepared.normals, NormalSource::corrected);
  EXPECT_TRUE(warns(prepared, "planes through 10 neighbours: estimated again"));
  EXPECT_GT(outward(prepared, exact), 0.995);
  EXPECT_LT(outward(prepare(input, Normals::file), exact), 0.95);
}

TEST(PrepareNormals, KeepsTheNormalsOfTwoBodiesInContact) {
  const PointCloud input = joined(box_cloud({0, 0, 0}, {1, 1, 1}, 500), box_cloud({1.01, 0, 0}, {2.01, 1, 1}, 500));
  const PreparedCloud prepared = prepare(input, Normals::automatic);
  EXPECT_EQ(prepared.normals, NormalSource::file);
  Index changed = 0;
  for (Index i = 0; i < prepared.cloud.size(); ++i)
    changed += prepared.cloud.normals.col(i).dot(input.normals.col(prepared.source[i])) < 0 ? 1 : 0;
  EXPECT_LT(changed, prepared.cloud.size() / 200);  // single ones, at edges
}

TEST(PrepareNormals, ReorientsAnOpenSheetWithFlippedPatches) {
  PointCloud input{Points<3>(3, 4000), Points<3>::Zero(3, 4000), {}};
  for (Index i = 0; i < 4000; ++i) {
    const Eigen::Vector2d uv = quasi_random(i, 1);
    input.points.col(i) << uv[0], uv[1], 0.05 * std::sin(6 * uv[0]);
    input.normals.col(i) = Point<3>(-0.3 * std::cos(6 * uv[0]), 0, 1).normalized();
    if (uv.x() > 0.3 && uv.x() < 0.5 && uv.y() < 0.4) input.normals.col(i) *= -1;
  }
  const PreparedCloud prepared = prepare(input, Normals::automatic);
  EXPECT_EQ(prepared.normals, NormalSource::reoriented);
  const Eigen::ArrayXd up = prepared.cloud.normals.row(2).array();
  EXPECT_TRUE((up > 0).all() || (up < 0).all());
}

PointCloud inside_out(PointCloud cloud) {
  cloud.normals *= -1;
  return cloud;
}

TEST(PrepareNormals, TurnsNormalsThatPointInward) {
  const PointCloud cloud = inside_out(sphere_cloud(3000));
  const PreparedCloud turned = prepare(cloud, Normals::automatic);
  EXPECT_TRUE(warns(turned, "point inward: turned"));
  EXPECT_EQ(turned.normals, NormalSource::reoriented);
  EXPECT_GT(outward(turned, cloud), 0.99);
  const PreparedCloud kept = prepare(cloud, Normals::file);
  EXPECT_TRUE(warns(kept, "point inward"));
  EXPECT_EQ(kept.normals, NormalSource::file);
  EXPECT_LT(outward(kept, cloud), -0.99);
}

TEST(PrepareNormals, SaysThatAPartOfTheSurfaceHasFarFewerSamples) {
  const PointCloud even = sphere_cloud(4000);
  std::vector<Index> ids;
  for (Index i = 0; i < even.size(); ++i)
    if (even.points(0, i) < 0 || i % 40 == 0) ids.push_back(i);
  PointCloud uneven;
  uneven.points = even.points(Eigen::all, ids);
  for (const PointCloud& cloud : {even, uneven}) {
    PreparedCloud prepared = prepare(cloud, Normals::automatic);
    warn_of_sparse_parts(prepared);
    EXPECT_EQ(warns(prepared, "as far apart"), cloud.size() < even.size());
  }
}

// On parts as thin as two or three spacings, smoothing takes much of the winding number away.
TEST(PrepareNormals, TurnsNormalsOfThinRingsThatPointInward) {
  constexpr double thickness = 0.05;
  PointCloud ring;
  ring.points.resize(3, 1000);
  ring.normals.resize(3, 1000);
  for (Index i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d angle = 2 * std::numbers::pi * quasi_random(i, 1);
    const Point<3> middle(std::cos(angle[0]), std::sin(angle[0]), 0);
    ring.normals.col(i) = std::cos(angle[1]) * middle + std::sin(angle[1]) * Point<3>::UnitZ();
    ring.points.col(i) = middle + thickness * ring.normals.col(i);
  }
  EXPECT_TRUE(warns(prepare(inside_out(ring), Normals::automatic), "point inward: turned"));
  EXPECT_FALSE(warns(prepare(ring, Normals::automatic), "point inward"));
}

TEST(PrepareNormals, TurnsOnlyTheBodyWhoseNormalsPointInward) {
  const PointCloud good = sphere_cloud(3000), bad = inside_out(sphere_cloud(2000, 2, 1, {3, 0, 0}));
  const PointCloud cloud = joined(good, bad);
  const PreparedCloud turned = prepare(cloud, Normals::automatic);
  EXPECT_TRUE(warns(turned, "point inward on some parts: turned"));
  for (Index i = 0; i < turned.cloud.size(); ++i) {
    const Index from = turned.source[i];
    const Point<3> center(from < good.size() ? 0 : 3, 0, 0);
    EXPECT_GT(turned.cloud.normals.col(i).dot(cloud.points.col(from) - center), 0.9);
  }
}

TEST(PrepareNormals, KeepsNormalsOfCavitiesAndOpenSheets) {
  const PointCloud hollow = joined(sphere_cloud(3000), inside_out(sphere_cloud(2000, 2, 0.5)));
  EXPECT_EQ(prepare(hollow, Normals::automatic).normals, NormalSource::file);
  PointCloud bowl = inside_out(sphere_cloud(3000));
  std::vector<Index> lower;
  for (Index i = 0; i < bowl.size(); ++i)
    if (bowl.points(2, i) < 0) lower.push_back(i);
  bowl = {bowl.points(Eigen::all, lower), bowl.normals(Eigen::all, lower), {}};
  EXPECT_EQ(prepare(bowl, Normals::automatic).normals, NormalSource::file);
}

TEST(PrepareNormals, FillsMissingNormals) {
  PointCloud input = sphere_cloud(2000);
  for (Index i = 0; i < 2000; i += 3) input.normals.col(i).setZero();
  input.normals(1, 1) = nan;
  input.normals(2, 2) = infinity;
  const PreparedCloud prepared = prepare(input, Normals::file);
  EXPECT_EQ(prepared.normals, NormalSource::file);
  EXPECT_TRUE(warns(prepared, "669 missing normals estimated"));
  expect_points_of_the_input(prepared, input);
  for (Index i = 0; i < prepared.cloud.size(); ++i)
    EXPECT_GT(prepared.cloud.normals.col(i).dot(input.points.col(prepared.source[i])), 0.98);
}

TEST(PrepareNormals, FillsMissingNormalsFarFromOthersOnTheSideOfMost) {
  const PointCloud exact = sphere_cloud(2000);
  for (const double side : {1.0, -1.0}) {
    PointCloud input = exact;
    input.normals *= side;
    for (Index i = 0; i < 2000; ++i)
      if (input.points(2, i) > 0.2) input.normals.col(i).setZero();
    const PreparedCloud prepared = prepare(input, Normals::file);
    for (Index i = 0; i < prepared.cloud.size(); ++i)
      EXPECT_GT(side * prepared.cloud.normals.col(i).dot(exact.points.col(prepared.source[i])), 0.98);
  }
}

// On a body that has its normals inward, unlike most points.
TEST(PrepareNormals, FillsMissingNormalsLikeTheLastOfTheirNeighbors) {
  constexpr Index large = 3000, n = 5000;
  constexpr std::size_t neighbors = 9;  // that prepare() looks at
  const Point<3> center(3, 0, 0);
  PointCloud input = joined(sphere_cloud(large), sphere_cloud(n - large, 2, 0.8, center));
  input.normals.rightCols(n - large) *= -1;
  const Points<3> given = input.normals;
  const KdTree<3> tree(input.points);
  std::vector<Index> centers;
  std::set<Index> used;
  for (Index i = large; i < n; i += 10) {
    std::array<Index, neighbors + 1> ids{};
    std::array<double, neighbors + 1> d2{};
    tree.nearest(input.points.col(i), neighbors + 1, ids.data(), d2.data());
    if (std::any_of(ids.begin(), ids.end(), [&](Index j) { return used.contains(j); })) continue;
    used.insert(ids.begin(), ids.end());
    for (std::size_t k = 0; k < neighbors; ++k) input.normals.col(ids[k]).setZero();  // all but the last
    centers.push_back(i);
  }
  ASSERT_GT(centers.size(), 30U);
  const PreparedCloud prepared = prepare(input, Normals::file);
  ASSERT_EQ(prepared.cloud.size(), n);
  for (Index i = 0; i < n; ++i)
    if (const Index from = prepared.source[i]; std::find(centers.begin(), centers.end(), from) != centers.end()) {
      EXPECT_GT(prepared.cloud.normals.col(i).dot(given.col(from)), 0.9) << from;
    }
}

TEST(PrepareNormals, EstimatesAllNormalsWhenMostAreMissing) {
  PointCloud input = sphere_cloud(2000);
  input.normals.rightCols(1500).setZero();
  const PreparedCloud prepared = prepare(input, Normals::file);
  EXPECT_EQ(prepared.normals, NormalSource::estimated);
  EXPECT_TRUE(warns(prepared, "most normals are missing"));
  EXPECT_GT(outward(prepared, input), 0.99);
}

// As exporters write them for points without one.
TEST(PrepareNormals, OneNormalSharedByScatteredPointsIsMissing) {
  const PointCloud exact = sphere_cloud(2000);
  for (const Index one_in : {3, 1}) {
    PointCloud input = exact;
    for (Index i = 0; i < 2000; i += one_in) input.normals.col(i) = Point<3>(0, 0, 1);
    const PreparedCloud prepared = prepare(input, Normals::automatic);
    EXPECT_TRUE(warns(prepared, "normals are all (0, 0, 1) though their points lie in no plane: taken as missing"));
    EXPECT_EQ(prepared.normals, one_in == 1 ? NormalSource::estimated : NormalSource::file);
    for (Index i = 0; i < prepared.cloud.size(); ++i)
      EXPECT_GT(prepared.cloud.normals.col(i).dot(exact.points.col(prepared.source[i])), 0.98);
  }
}

TEST(PrepareNormals, InAnotherFrameAreEstimated) {
  PointCloud input = sphere_cloud(2000);
  const PointCloud exact = input;
  for (Index i = 0; i < 2000; ++i)
    input.normals.col(i) = Point<3>(input.normals(0, i), input.normals(2, i), -input.normals(1, i));
  const PreparedCloud prepared = prepare(input, Normals::automatic);
  EXPECT_EQ(prepared.normals, NormalSource::estimated);
  EXPECT_TRUE(warns(prepared, "perhaps in another coordinate frame: all estimated"));
  EXPECT_GT(outward(prepared, exact), 0.99);
}

// The faces at the rim are narrower than the distance of points: planes through neighbours are those of the plate.
TEST(PrepareNormals, OfThinPlatesAreNotMissing) {
  PointCloud plate;
  plate.points.resize(3, 4000);
  plate.normals.resize(3, 4000);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (Index i = 0; i < 4000; ++i) {
    const Index axis = i % 10 == 0 ? i / 10 % 2 : 2;
    const double side = random() % 2 == 0 ? 1 : -1;
    Point<3> x(uniform(random), uniform(random), uniform(random));
    x[axis] = side;
    x[2] *= 0.01;
    plate.points.col(i) = x;
    plate.normals.col(i) = side * Point<3>::Unit(axis);
  }
  const PreparedCloud prepared = prepare(plate, Normals::automatic);
  EXPECT_FALSE(warns(prepared, "taken as missing"));
  EXPECT_FALSE(warns(prepared, "estimated"));
}

// A second scan of the lower half, moved by 1.3 spacings.
TEST(PrepareNormals, OfTwoScansThatDoNotFitAreThoseOfOneSurface) {
  constexpr Index n = 2000;
  const auto scans = [](const PointCloud& first, const PointCloud& again, double shift) {
    std::vector<Index> half;
    for (Index i = 0; i < again.size(); ++i)
      if (again.points(2, i) < 0) half.push_back(i);
    PointCloud second{again.points(Eigen::all, half), again.normals(Eigen::all, half), {}};
    second.points.colwise() += shift * Point<3>(1, 2, 3).normalized();
    return joined(first, second);
  };
  for (const unsigned seed : {1U, 2U, 3U}) {
    const double of_sphere = std::sqrt(4 * pi / n), of_torus = std::sqrt(Torus{}.area() / n);
    for (const PointCloud& cloud :
         {scans(sphere_cloud(n, seed), sphere_cloud(2 * n / 3, seed + 50), 1.3 * of_sphere),
          scans(Torus{}.cloud(n, seed), Torus{}.cloud(2 * n / 3, seed + 50), 1.3 * of_torus)}) {
      const PreparedCloud prepared = prepare(without_normals(cloud), Normals::automatic);
      Index outside = 0;
      for (Index i = 0; i < prepared.cloud.size(); ++i)
        outside += prepared.cloud.normals.col(i).dot(cloud.normals.col(prepared.source[i])) > 0 ? 1 : 0;
      EXPECT_GT(outside, 0.97 * static_cast<double>(prepared.cloud.size())) << seed;
    }
  }
}

}  // namespace
}  // namespace csrbf::prepare_normals_test
