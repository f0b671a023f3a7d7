#include "csrbf/spatial/morton_order.hpp"

#include "spatial/spatial_testing.hpp"

#include <numeric>

namespace csrbf::morton_order_test {
namespace {

template <class T>
class MortonOrderIn : public testing::Test {};
TYPED_TEST_SUITE(MortonOrderIn, Dimensions);

template <int Dim>
double path_length(const Points<Dim>& points, const std::vector<Index>& order) {
  double length = 0;
  for (std::size_t i = 1; i < order.size(); ++i) length += (points.col(order[i]) - points.col(order[i - 1])).norm();
  return length;
}

TEST(MortonOrder, DrawsAZThroughTheQuartersOfASquare) {
  Points<2> corners(2, 4);
  corners << 1, 0, 1, 0,  //
      1, 1, 0, 0;
  EXPECT_EQ(morton_order<2>(corners), (std::vector<Index>{3, 2, 1, 0}));  // (0,0) (1,0) (0,1) (1,1)
}

TEST(MortonOrder, VisitsAGridByTheInterleavedBitsOfItsCoordinates) {
  constexpr Index side = 8;
  Points<2> grid(2, side * side);
  std::vector<Index> expected(side * side);
  for (Index y = 0; y < side; ++y) {
    for (Index x = 0; x < side; ++x) {
      Index code = 0;
      for (Index bit = 0; bit < 3; ++bit) code |= (x >> bit & 1) << 2 * bit | (y >> bit & 1) << (2 * bit + 1);
      grid.col(y * side + x) = Point<2>(static_cast<double>(x), static_cast<double>(y));
      expected[code] = y * side + x;
    }
  }
  grid *= static_cast<double>(side - 1) / static_cast<double>(side);  // any scale
  EXPECT_EQ(morton_order<2>(grid), expected);
}

TEST(MortonOrder, SortsALine) {
  const Points<1> points = uniform_points<1>(500, 3);
  const std::vector<Index> order = morton_order<1>(points);
  EXPECT_TRUE(
      std::is_sorted(order.begin(), order.end(), [&](Index a, Index b) { return points(0, a) < points(0, b); }));
}

TYPED_TEST(MortonOrderIn, IsAPermutation) {
  constexpr int Dim = TypeParam::value;
  for (const Index n : {0, 1, 2, 500}) {
    for (const auto& [name, points] : point_sets<Dim>(n)) {
      std::vector<Index> order = morton_order<Dim>(points);
      std::sort(order.begin(), order.end());
      std::vector<Index> expected(n);
      std::iota(expected.begin(), expected.end(), Index{0});
      EXPECT_EQ(order, expected) << name;
    }
  }
}

TYPED_TEST(MortonOrderIn, KeepsTheInputOrderOfEqualPoints) {
  constexpr int Dim = TypeParam::value;
  const Points<Dim> points = duplicated_points<Dim>(300, 2);
  const std::vector<Index> order = morton_order<Dim>(points);
  for (std::size_t i = 1; i < order.size(); ++i)
    EXPECT_TRUE(points.col(order[i]) != points.col(order[i - 1]) || order[i] > order[i - 1]);
}

TYPED_TEST(MortonOrderIn, KeepsNeighboursTogether) {
  constexpr int Dim = TypeParam::value;
  const Points<Dim> points = uniform_points<Dim>(2000, 1);
  std::vector<Index> as_given(2000);
  std::iota(as_given.begin(), as_given.end(), Index{0});
  // Steps of the order of the spacing n^(-1/Dim) instead of the size of the box.
  EXPECT_LT(path_length<Dim>(points, morton_order<Dim>(points)), .7 * path_length<Dim>(points, as_given));
}

TYPED_TEST(MortonOrderIn, DoesNotDependOnScaleOrPosition) {
  constexpr int Dim = TypeParam::value;
  const Points<Dim> points = grid_points<Dim>(200, 4).array().round();
  const std::vector<Index> expected = morton_order<Dim>(points);
  for (const double scale : {std::ldexp(1.0, -100), 2.0, std::ldexp(1.0, 100)}) {
    EXPECT_EQ(morton_order<Dim>(Points<Dim>(scale * points)), expected);
    EXPECT_EQ(morton_order<Dim>(Points<Dim>((scale * points).array() + 64 * scale)), expected);
  }
}

TYPED_TEST(MortonOrderIn, RoughIsAPermutationThatKeepsNeighboursTogether) {
  constexpr int Dim = TypeParam::value;
  for (const auto& [name, points] : point_sets<Dim>(500)) {
    std::vector<Index> order = rough_morton_order<Dim>(points);
    std::sort(order.begin(), order.end());
    std::vector<Index> expected(points.cols());
    std::iota(expected.begin(), expected.end(), Index{0});
    EXPECT_EQ(order, expected) << name;
  }
  const Points<Dim> points = uniform_points<Dim>(20'000, 1);
  EXPECT_LT(path_length<Dim>(points, rough_morton_order<Dim>(points)),
            1.3 * path_length<Dim>(points, morton_order<Dim>(points)));
}

TYPED_TEST(MortonOrderIn, RoughIsExactForAClusterInAWideBox) {
  constexpr int Dim = TypeParam::value;
  Points<Dim> points = 1e-6 * uniform_points<Dim>(2000, 1);
  points.col(7).setOnes();
  EXPECT_EQ(rough_morton_order<Dim>(points), morton_order<Dim>(points));
}

}  // namespace
}  // namespace csrbf::morton_order_test
