#include "csrbf/surface/normals/neighbor_table.hpp"

#include <gtest/gtest.h>

#include <random>

namespace csrbf::neighbor_table_test {
namespace {

Points<3> random_points(Index n) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Points<3>::NullaryExpr(3, n, [&] { return uniform(random); });
}

// Every `stride`-th column is left out.
std::vector<Index> all_but_every(Index stride, Index n) {
  std::vector<Index> kept;
  for (Index i = 0; i < n; ++i)
    if (i % stride != 0) kept.push_back(i);
  return kept;
}

TEST(NeighborTable, HoldsTheNearestPointsInOrder) {
  const Points<3> x = random_points(300);
  const NeighborTable table = make_neighbor_table(x, KdTree<3>(x), 7);
  for (Index i = 0; i < x.cols(); ++i) {
    std::vector<std::pair<double, Index>> others;
    for (Index j = 0; j < x.cols(); ++j)
      if (j != i) others.emplace_back((x.col(j) - x.col(i)).norm(), j);
    std::sort(others.begin(), others.end());
    for (std::size_t k = 0; k < 7; ++k) EXPECT_EQ(table.of(i)[k], others[k].second);
    EXPECT_NEAR(table.reach[i], others[6].first, 1e-15);
  }
}

TEST(NeighborTable, OfWhatIsLeftOfACloudIsThatOfANewSearch) {
  const Points<3> x = random_points(500);
  const NeighborTable before = make_neighbor_table(x, KdTree<3>(x), 6);
  for (const Index stride : {100, 7, 2}) {
    const std::vector<Index> kept = all_but_every(stride, x.cols());
    const Points<3> left = x(Eigen::all, kept);
    const KdTree<3> tree(left);
    const NeighborTable expected = make_neighbor_table(left, tree, 6);
    const NeighborTable table = make_neighbor_table(left, tree, before, kept);
    EXPECT_EQ(table.k, expected.k);
    EXPECT_EQ(table.index, expected.index);
    EXPECT_EQ(table.reach, expected.reach);
  }
}

TEST(NeighborTable, IsNarrowerWhenFewPointsAreLeft) {
  const Points<3> x = random_points(20);
  const NeighborTable before = make_neighbor_table(x, KdTree<3>(x), 9);
  const std::vector<Index> kept = {2, 3, 5, 11};
  const Points<3> left = x(Eigen::all, kept);
  const NeighborTable table = make_neighbor_table(left, KdTree<3>(left), before, kept);
  EXPECT_EQ(table.k, 3);
  EXPECT_EQ(table.index, make_neighbor_table(left, KdTree<3>(left), 9).index);
}

}  // namespace
}  // namespace csrbf::neighbor_table_test
