#include "csrbf/spatial/partition.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "spatial/spatial_testing.hpp"

#include <functional>
#include <numbers>
#include <numeric>
#include <set>

namespace csrbf::partition_test {
namespace {

template <class T>
class PartitionIn : public testing::Test {};
using OneToSixDimensions =
    testing::Types<InDimension<1>, InDimension<2>, InDimension<3>, InDimension<4>, InDimension<5>, InDimension<6>>;
TYPED_TEST_SUITE(PartitionIn, OneToSixDimensions);

template <int Dim>
PointPartition partition_of(const Points<Dim>& points, Index leaf_size) {
  return partition<Dim>(points, Points<Dim>(Dim, 0), Eigen::VectorXd(0), {.leaf_size = leaf_size});
}

std::vector<Index> leaf(const PointPartition& parts, Index i) {
  const auto at = [&](Index leaf) { return parts.order.begin() + parts.begin[leaf]; };
  std::vector<Index> ids(at(i), at(i + 1));
  std::sort(ids.begin(), ids.end());
  return ids;
}

std::set<std::vector<Index>> leaf_sets(const PointPartition& parts) {
  std::set<std::vector<Index>> sets;
  for (Index i = 0; i < parts.leaves(); ++i) sets.insert(leaf(parts, i));
  return sets;
}

void expect_every_index_once(const PointPartition& parts, Index n) {
  std::vector<Index> sorted = parts.order, all(static_cast<std::size_t>(n));
  std::sort(sorted.begin(), sorted.end());
  std::iota(all.begin(), all.end(), Index{0});
  EXPECT_EQ(sorted, all);
  ASSERT_FALSE(parts.begin.empty());
  EXPECT_EQ(parts.begin.front(), 0);
  EXPECT_EQ(parts.begin.back(), n);
  EXPECT_TRUE(std::adjacent_find(parts.begin.begin(), parts.begin.end(), std::greater_equal<>()) == parts.begin.end())
      << "a leaf is empty";
}

template <int Dim>
Eigen::Matrix<double, Dim, Dim> random_rotation(unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  using Matrix = Eigen::Matrix<double, Dim, Dim>;
  const Matrix G = Matrix::NullaryExpr([&] { return normal(random); });
  return thin_q(Eigen::HouseholderQR<Eigen::MatrixXd>(G), Dim);
}

// Points of a unit square at height z, one in each cell of a grid of cells of side `spacing`.
Points<3> jittered_square(Index side, double z, std::mt19937_64& random) {
  std::uniform_real_distribution<double> jitter(0.1, 0.9);
  Points<3> points(3, side * side);
  for (Index i = 0; i < points.cols(); ++i)
    points.col(i) << (static_cast<double>(i % side) + jitter(random)) / static_cast<double>(side),
        (static_cast<double>(i / side) + jitter(random)) / static_cast<double>(side), z;
  return points;
}

// Two squares of side x side points, `gap` spacings apart, turned; the first half of the columns is the lower one.
struct TwoSheets {
  Points<3> points, normals;
  Eigen::VectorXd spacing;
};
TwoSheets two_sheets(Index side, double gap, double upper_normal, unsigned seed) {
  std::mt19937_64 random(seed);
  const double h = 1.0 / static_cast<double>(side);
  const Eigen::Matrix3d R = random_rotation<3>(seed);
  const Index n = side * side;
  TwoSheets sheets;
  sheets.points.resize(3, 2 * n);
  sheets.points << R * jittered_square(side, 0, random), R * jittered_square(side, gap * h, random);
  sheets.normals.resize(3, 2 * n);
  sheets.normals.leftCols(n).colwise() = R.col(2);
  sheets.normals.rightCols(n).colwise() = upper_normal * R.col(2);
  sheets.spacing.setConstant(2 * n, h);
  return sheets;
}

Index leaves_with_both_sheets(const PointPartition& parts, Index n) {
  Index both = 0;
  for (Index i = 0; i < parts.leaves(); ++i) {
    const std::vector<Index> ids = leaf(parts, i);
    if (ids.front() < n && ids.back() >= n) ++both;
  }
  return both;
}

struct OrientedSphere {
  Points<3> points;
  Eigen::VectorXd spacing;
};
OrientedSphere random_sphere(Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  OrientedSphere sphere{Points<3>::NullaryExpr(3, n, [&] { return normal(random); }), {}};
  sphere.points.colwise().normalize();
  sphere.spacing.setConstant(n, std::sqrt(4 * std::numbers::pi / static_cast<double>(n)));
  return sphere;
}

TEST(Partition, OfALineCutsItInConsecutiveIntervals) {
  Points<1> line(1, 8);
  line << 5, 1, 7, 3, 0, 6, 2, 4;
  const std::set<std::vector<Index>> expected = {{1, 4}, {3, 6}, {0, 7}, {2, 5}};
  EXPECT_EQ(leaf_sets(partition_of<1>(line, 2)), expected);
}

TEST(Partition, CutsAcrossTheLongSide) {
  Points<2> points(2, 6);
  points << 0, 10, 20, 1, 11, 21,  //
      0, 1, 0, 1, 0, 1;
  const std::set<std::vector<Index>> expected = {{0, 3}, {1, 4}, {2, 5}};
  EXPECT_EQ(leaf_sets(partition_of<2>(points, 2)), expected);
}

TEST(Partition, InOneDimensionSortsTheLeaves) {
  const Points<1> points = uniform_points<1>(1000, 3);
  const PointPartition parts = partition_of<1>(points, 7);
  std::vector<std::pair<double, double>> ranges;
  for (Index i = 0; i < parts.leaves(); ++i) {
    std::pair<double, double> range(2, -2);
    for (const Index id : leaf(parts, i))
      range = {std::min(range.first, points(0, id)), std::max(range.second, points(0, id))};
    ranges.push_back(range);
  }
  std::sort(ranges.begin(), ranges.end());
  for (std::size_t i = 1; i < ranges.size(); ++i) EXPECT_LT(ranges[i - 1].second, ranges[i].first);
}

TYPED_TEST(PartitionIn, HoldsEveryIndexOnce) {
  constexpr int Dim = TypeParam::value;
  for (const Index n : {1, 2, 3, 50, 1000})
    for (const auto& [name, points] : point_sets<Dim>(n))
      for (const Index leaf_size : {1, 2, 7, 16, 5000}) {
        SCOPED_TRACE(name);
        expect_every_index_once(partition_of<Dim>(points, leaf_size), n);
        const Eigen::VectorXd spacing = Eigen::VectorXd::Constant(n, 0.01);
        const Points<Dim> normals = uniform_points<Dim>(n, 9).colwise().normalized();
        expect_every_index_once(partition<Dim>(points, normals, spacing, {.leaf_size = leaf_size}), n);
      }
}

TYPED_TEST(PartitionIn, HasLeavesOfEqualSizeGiveOrTakeOnePoint) {
  constexpr int Dim = TypeParam::value;
  for (const Index n : {1, 17, 101, 777, 3001})
    for (const auto& [name, points] : point_sets<Dim>(n))
      for (const Index leaf_size : {1, 4, 10, 33}) {
        const PointPartition parts = partition_of<Dim>(points, leaf_size);
        Index smallest = n, largest = 0;
        for (std::size_t i = 1; i < parts.begin.size(); ++i) {
          smallest = std::min(smallest, parts.begin[i] - parts.begin[i - 1]);
          largest = std::max(largest, parts.begin[i] - parts.begin[i - 1]);
        }
        EXPECT_LE(largest, leaf_size) << name;
        EXPECT_LE(largest - smallest, 1) << name;
        EXPECT_EQ(parts.leaves(), (n + leaf_size - 1) / leaf_size) << name;
      }
}

TYPED_TEST(PartitionIn, TurnsMovesAndScalesWithTheCloud) {
  constexpr int Dim = TypeParam::value;
  for (const Index n : {64, 1000, 1777}) {
    const Points<Dim> points = uniform_points<Dim>(n, 11);
    const std::set<std::vector<Index>> expected = leaf_sets(partition_of<Dim>(points, 10));
    for (unsigned seed = 1; seed <= 4; ++seed) {
      const Points<Dim> turned = random_rotation<Dim>(seed) * points;
      EXPECT_EQ(leaf_sets(partition_of<Dim>(turned, 10)), expected) << n;
    }
    const Points<Dim> moved = points.colwise() + Point<Dim>::Constant(1e3);
    EXPECT_EQ(leaf_sets(partition_of<Dim>(moved, 10)), expected) << n;
    for (const double scale : {0x1p-100, 0x1p100})
      EXPECT_EQ(leaf_sets(partition_of<Dim>(scale * points, 10)), expected) << n;
  }
}

TEST(Partition, WithNormalsAndSpacingTurnsWithTheCloud) {
  const OrientedSphere sphere = random_sphere(3000, 5);
  const auto leaves = [&](const Eigen::Matrix3d& R) {
    const Points<3> turned = R * sphere.points;
    return leaf_sets(partition<3>(turned, turned, sphere.spacing, {.leaf_size = 13}));
  };
  const std::set<std::vector<Index>> expected = leaves(Eigen::Matrix3d::Identity());
  for (unsigned seed = 1; seed <= 4; ++seed) EXPECT_EQ(leaves(random_rotation<3>(seed)), expected);
}

TEST(Partition, DoesNotDependOnTheNumberOfThreads) {
  const OrientedSphere sphere = random_sphere(20000, 6);
  set_thread_count(1);
  const PointPartition serial = partition<3>(sphere.points, sphere.points, sphere.spacing, {.leaf_size = 12});
  for (const int threads : {2, 5}) {
    set_thread_count(threads);
    const PointPartition parallel = partition<3>(sphere.points, sphere.points, sphere.spacing, {.leaf_size = 12});
    EXPECT_EQ(parallel.order, serial.order);
    EXPECT_EQ(parallel.begin, serial.begin);
  }
  set_thread_count(0);
}

// So that every standard library makes the same parts, of which those of many points are cut by a sample.
TEST(Partition, KeepsTheOrderOfThePointsInALeaf) {
  const PointPartition parts = partition_of<3>(uniform_points<3>(3000, 5), 40);
  for (Index i = 0; i < parts.leaves(); ++i)
    EXPECT_TRUE(std::is_sorted(parts.order.begin() + parts.begin[i], parts.order.begin() + parts.begin[i + 1]));
}

TEST(Partition, NeverBridgesAGapBetweenParallelSheets) {
  for (const Index leaf_size : {4, 8, 16, 40})
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const TwoSheets sheets = two_sheets(40, 3, 1, seed);
      const PointPartition parts =
          partition<3>(sheets.points, sheets.normals, sheets.spacing, {.leaf_size = leaf_size});
      EXPECT_EQ(leaves_with_both_sheets(parts, 1600), 0) << leaf_size << " " << seed;
    }
}

TEST(Partition, NeverHoldsMuchOfBothSidesOfAThinSheet) {
  for (const Index leaf_size : {4, 8, 16, 40})
    for (const double gap : {0.0, 0.1, 1.0})
      for (unsigned seed = 1; seed <= 3; ++seed) {
        const TwoSheets sheets = two_sheets(40, gap, -1, seed);
        const PointPartition parts =
            partition<3>(sheets.points, sheets.normals, sheets.spacing, {.leaf_size = leaf_size});
        for (Index i = 0; i < parts.leaves(); ++i) {
          const std::vector<Index> ids = leaf(parts, i);
          const auto lower = std::count_if(ids.begin(), ids.end(), [](Index id) { return id < 1600; });
          const auto size = static_cast<double>(ids.size());
          // Share p of one side: the mean normal is |2p - 1| long.
          EXPECT_GE(std::abs(2 * static_cast<double>(lower) - size), 0.6 * size);
        }
      }
}

TEST(Partition, LeavesOneSheetWhole) {
  std::mt19937_64 random(8);
  const Points<3> points = jittered_square(64, 0, random);
  const Points<3> normals = Point<3>::UnitZ().replicate(1, 4096);
  const Eigen::VectorXd spacing = Eigen::VectorXd::Constant(4096, 1.0 / 64);
  const PointPartition parts = partition<3>(points, normals, spacing, {.leaf_size = 16});
  EXPECT_EQ(parts.leaves(), 256);
}

TEST(Partition, OfACurvedSurfaceHasNoLongGapAndNoSharpBendInALeaf) {
  const PointPartitionOptions options{.leaf_size = 20};
  const OrientedSphere sphere = random_sphere(400, 12);  // leaves that reach far around
  const PointPartition parts = partition<3>(sphere.points, sphere.points, sphere.spacing, options);
  for (Index i = 0; i < parts.leaves(); ++i) {
    const std::vector<Index> ids = leaf(parts, i);
    const Points<3> points = sphere.points(Eigen::all, ids);
    EXPECT_GE(points.rowwise().mean().norm(), options.min_mean_normal);
    const Points<3> centered = points.colwise() - points.rowwise().mean();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(centered * centered.transpose());
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::VectorXd along = centered.transpose() * principal.eigenvectors().col(axis);
      std::sort(along.begin(), along.end());
      for (Index k = 1; k < along.size(); ++k)
        EXPECT_LE(along[k] - along[k - 1], options.max_gap * sphere.spacing[0] * (1 + 1e-12));
    }
  }
}

TEST(Partition, PutsNeighbouringLeavesNextToEachOther) {
  const OrientedSphere sphere = random_sphere(8192, 13);
  const PointPartition parts = partition<3>(sphere.points, sphere.points, sphere.spacing, {.leaf_size = 8});
  double sum = 0;
  Point<3> previous = Point<3>::Zero();
  for (Index i = 0; i < parts.leaves(); ++i) {
    const Point<3> center = sphere.points(Eigen::all, leaf(parts, i)).rowwise().mean();
    if (i > 0) sum += (center - previous).norm();
    previous = center;
  }
  // A leaf is 0.11 wide; in random order the mean distance is 4/3.
  EXPECT_LT(sum / static_cast<double>(parts.leaves() - 1), 0.25);
}

TEST(Partition, OfNothingHasNoLeaf) {
  const PointPartition parts = partition_of<3>(Points<3>(3, 0), 16);
  EXPECT_EQ(parts.leaves(), 0);
  EXPECT_TRUE(parts.order.empty());
}

TEST(Partition, OfIdenticalPointsStillHasSmallLeaves) {
  const Points<3> points = Points<3>::Constant(3, 100, 0.3);
  const Points<3> normals = Point<3>::UnitX().replicate(1, 100);
  const PointPartition parts = partition<3>(points, normals, Eigen::VectorXd::Zero(100), {.leaf_size = 10});
  expect_every_index_once(parts, 100);
  EXPECT_EQ(parts.leaves(), 10);
}

TYPED_TEST(PartitionIn, HalvesAcrossTheLongestAxis) {
  constexpr int Dim = TypeParam::value;
  for (const Index n : {1, 2, 9, 100}) {
    Points<Dim> points = uniform_points<Dim>(n, 14);
    points.row(0) *= 10;
    const Points<Dim> turned = random_rotation<Dim>(3) * points;
    std::vector<Index> ids(n);
    std::iota(ids.begin(), ids.end(), Index{0});
    const Index middle = halve<Dim>(turned, Points<Dim>(Dim, 0), ids.data(), n);
    EXPECT_EQ(middle, n / 2);
    std::vector<Index> sorted = ids;
    std::sort(sorted.begin(), sorted.end());
    for (Index i = 0; i < n; ++i) EXPECT_EQ(sorted[i], i);
    if (n < 100) continue;
    // The principal axis is nearly the long side: the halves overlap along it by a fraction of its length at most.
    const auto mean = [&](Index begin, Index end) {
      double sum = 0;
      for (Index i = begin; i < end; ++i) sum += points(0, ids[i]);
      return sum / static_cast<double>(end - begin);
    };
    EXPECT_GT(std::abs(mean(0, middle) - mean(middle, n)), 8);
  }
}

TEST(Partition, CutsANoisySheetAcrossNotAlong) {
  // Thicker than its leaves are wide.
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform;
  Points<3> points(3, 4096);
  for (Index i = 0; i < points.cols(); ++i) points.col(i) << uniform(random), uniform(random), 0.2 * uniform(random);
  const Points<3> up = Point<3>::UnitZ().replicate(1, points.cols());
  const PointPartition parts = partition<3>(points, up, Eigen::VectorXd(0), {.leaf_size = 16});
  ASSERT_EQ(parts.leaves(), 256);
  for (std::size_t leaf = 0; leaf < 256; ++leaf) {
    Box<3> box;
    for (Index k = parts.begin[leaf]; k < parts.begin[leaf + 1]; ++k) box.add(Point<3>(points.col(parts.order[k])));
    EXPECT_LT(box.extent().head<2>().maxCoeff(), 0.2);  // three times the side of 1 / 256 of the square
  }
}

TEST(Partition, HalvesTheGivenPointsOnly) {
  Points<1> line(1, 6);
  line << 0, 100, 1, 2, 200, 3;
  std::vector<Index> ids = {5, 0, 3, 2};
  EXPECT_EQ(halve<1>(line, Points<1>(1, 0), ids.data(), 4), 2);
  std::set<std::set<Index>> halves = {{ids[0], ids[1]}, {ids[2], ids[3]}};
  EXPECT_EQ(halves, (std::set<std::set<Index>>{{0, 2}, {3, 5}}));
}

TEST(Partition, RejectsEmptyLeavesAndArraysThatDoNotFitThePoints) {
  const Points<3> points = uniform_points<3>(5, 1);
  const Points<3> none(3, 0);
  EXPECT_EQ(invalid_input_message([&] { partition<3>(points, none, Eigen::VectorXd(0), {.leaf_size = 0}); }),
            "partition: leaf_size = 0: must be at least 1");
  EXPECT_EQ(invalid_input_message([&] { partition<3>(points, points.leftCols(4), Eigen::VectorXd(0)); }),
            "partition: normals = 4: one per point or none");
  EXPECT_EQ(invalid_input_message([&] { partition<3>(points, none, Eigen::VectorXd::Ones(6)); }),
            "partition: spacing = 6: one per point or none");
}

// Checks that the cuts between leaves [first, last) are nested, each in the middle of its part.
void expect_halves(const PointPartition& parts, Index first, Index last, Index leaf_size) {
  if (last - first < 2) return;
  const auto begin = parts.depth.begin();
  const auto cut = std::min_element(begin + first + 1, begin + last);
  EXPECT_EQ(std::count(begin + first + 1, begin + last, *cut), 1);
  const Index middle = cut - begin;
  const Index left = parts.begin[middle] - parts.begin[first], right = parts.begin[last] - parts.begin[middle];
  EXPECT_LE(std::abs(left - right), leaf_size + 1);
  expect_halves(parts, first, middle, leaf_size);
  expect_halves(parts, middle, last, leaf_size);
}

TEST(Partition, TellsHowDeepItsCutsAre) {
  const PointPartition parts = partition_of<2>(uniform_points<2>(1000, 3), 12);
  ASSERT_EQ(std::ssize(parts.depth), parts.leaves());
  EXPECT_EQ(parts.depth[0], 0);
  expect_halves(parts, 0, parts.leaves(), 12);
}

TEST(Partition, TellsCutsBetweenSheets) {
  Points<3> points(3, 8), normals(3, 8);
  for (Index i = 0; i < 8; ++i) {
    points.col(i) << static_cast<double>(i % 4), 0.1 * static_cast<double>(i % 3), i < 4 ? 0.0 : 1.0;
    normals.col(i) << 0, 0, i < 4 ? -1.0 : 1.0;
  }
  const PointPartition parts = partition<3>(points, normals, Eigen::VectorXd::Ones(8), {.leaf_size = 8});
  EXPECT_EQ(parts.depth, (std::vector<int>{0, -1}));
}

}  // namespace
}  // namespace csrbf::partition_test
