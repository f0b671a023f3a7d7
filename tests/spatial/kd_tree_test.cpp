#include "csrbf/spatial/kd_tree.hpp"

#include "spatial/spatial_testing.hpp"

#include <set>

namespace csrbf::kd_tree_test {
namespace {

constexpr double rounding = 1e-14;  // relative: the tree and the test may sum the squares in different orders

template <int Dim>
std::vector<double> sorted_distances(const Points<Dim>& points, const Point<Dim>& x) {
  std::vector<double> distances;
  for (Index i = 0; i < points.cols(); ++i) distances.push_back(squared_distance<Dim>(points.col(i), x));
  std::sort(distances.begin(), distances.end());
  return distances;
}

// Points of the set and points that are not in it, inside and far outside.
template <int Dim>
Points<Dim> queries(const Points<Dim>& points) {
  const Index own = std::min<Index>(points.cols(), 5);
  Points<Dim> x(Dim, own + 11);
  x.leftCols(own) = points.leftCols(own);
  x.rightCols(11) = uniform_points<Dim>(11, 77);
  x.col(own) *= 100;
  return x;
}

template <class T>
class KdTreeIn : public testing::Test {};
TYPED_TEST_SUITE(KdTreeIn, Dimensions);

TEST(KdTree, FindsTheNeighboursOnALine) {
  Points<1> points(1, 5);
  points << 10, 0, 3, 4, 20;
  const KdTree<1> tree(points);
  Index indices[3];
  double distances[3];
  ASSERT_EQ(tree.nearest(Point<1>(4.5), 3, indices, distances), 3);
  EXPECT_EQ(std::vector(indices, indices + 3), (std::vector<Index>{3, 2, 1}));
  EXPECT_EQ(std::vector(distances, distances + 3), (std::vector<double>{.25, 2.25, 20.25}));
  std::vector<Index> inside{99};
  tree.within(Point<1>(4.5), 5.6, inside);
  EXPECT_EQ(inside, (std::vector<Index>{0, 1, 2, 3}));
}

TYPED_TEST(KdTreeIn, FindsTheNearestNeighboursOfASearchThroughAllPoints) {
  constexpr int Dim = TypeParam::value;
  for (const Index n : {1, 2, 16, 17, 400}) {
    for (const auto& [name, points] : point_sets<Dim>(n)) {
      const KdTree<Dim> tree(points);
      EXPECT_EQ(tree.size(), n);
      const Points<Dim> x = queries<Dim>(points);
      for (Index q = 0; q < x.cols(); ++q) {
        const std::vector<double> expected = sorted_distances<Dim>(points, x.col(q));
        for (const Index k : {Index{1}, Index{2}, Index{5}, Index{20}, n, n + 3}) {
          std::vector<Index> indices(k);
          std::vector<double> distances(k);
          const Index found = tree.nearest(x.col(q), k, indices.data(), distances.data());
          ASSERT_EQ(found, std::min(k, n)) << name;
          const auto count = static_cast<std::size_t>(found);
          EXPECT_EQ(std::set<Index>(indices.begin(), indices.begin() + found).size(), count) << name;
          // Which of several equally distant points come last is not said: the distances decide.
          for (std::size_t i = 0; i < count; ++i) {
            EXPECT_NEAR(distances[i], expected[i], rounding * expected[i]) << name;
            EXPECT_NEAR(distances[i], squared_distance<Dim>(points.col(indices[i]), x.col(q)), rounding * expected[i]);
          }
        }
      }
    }
  }
}

TYPED_TEST(KdTreeIn, FindsThePointsWithinARadiusOfASearchThroughAllPoints) {
  constexpr int Dim = TypeParam::value;
  for (const auto& [name, points] : point_sets<Dim>(400)) {
    const KdTree<Dim> tree(points);
    const Points<Dim> x = queries<Dim>(points);
    for (Index q = 0; q < x.cols(); ++q) {
      for (const double radius : {0.0, 1e-3, .1234, .777, 1000.0}) {
        std::vector<Index> expected;
        for (Index i = 0; i < points.cols(); ++i)
          if (squared_distance<Dim>(points.col(i), x.col(q)) < radius * radius) expected.push_back(i);
        std::vector<Index> indices{-1, -1};
        tree.within(x.col(q), radius, indices);
        EXPECT_EQ(indices, expected) << name << " " << radius;
        EXPECT_EQ(tree.any_within(x.col(q), radius), !expected.empty()) << name << " " << radius;
      }
    }
  }
}

TEST(KdTree, LeavesOutThePointsAtTheRadiusItself) {
  Points<2> points(2, 3);
  points << 0, 3, 6,  //
      0, 4, 8;
  const KdTree<2> tree(points);
  std::vector<Index> indices;
  tree.within(Point<2>::Zero(), 5, indices);
  EXPECT_EQ(indices, std::vector<Index>{0});
  tree.within(Point<2>::Zero(), std::nextafter(5.0, 6.0), indices);
  EXPECT_EQ(indices, (std::vector<Index>{0, 1}));
}

TEST(KdTree, OfNoPointsFindsNothing) {
  const Points<3> none(3, 0);
  const KdTree<3> tree(none);
  EXPECT_EQ(tree.size(), 0);
  Index index = 0;
  double distance = 0;
  EXPECT_EQ(tree.nearest(Point<3>::Zero(), 1, &index, &distance), 0);
  std::vector<Index> indices{7};
  tree.within(Point<3>::Zero(), 1, indices);
  EXPECT_TRUE(indices.empty());
  EXPECT_FALSE(tree.any_within(Point<3>::Zero(), 1));
}

TEST(KdTree, FindsNothingWhenAskedForNoNeighbours) {
  const Points<3> points = uniform_points<3>(10, 1);
  EXPECT_EQ(KdTree<3>(points).nearest(Point<3>::Zero(), 0, nullptr, nullptr), 0);
}

TEST(KdTree, CanBeMoved) {
  const Points<2> points = uniform_points<2>(100, 1);
  KdTree<2> tree(points);
  KdTree<2> moved(std::move(tree));
  tree = std::move(moved);
  Index index = 0;
  double distance = 1;
  EXPECT_EQ(tree.nearest(points.col(42), 1, &index, &distance), 1);
  EXPECT_EQ(index, 42);
  EXPECT_EQ(distance, 0);
}

}  // namespace
}  // namespace csrbf::kd_tree_test
