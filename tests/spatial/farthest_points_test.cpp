#include "csrbf/spatial/farthest_points.hpp"

#include "csrbf/core/error.hpp"
#include "spatial/spatial_testing.hpp"

#include <limits>

namespace csrbf::farthest_points_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The method as it is defined, O(count n).
template <int Dim>
FarthestPoints brute_force(const Points<Dim>& points, Index count, Index first) {
  FarthestPoints picks;
  std::vector<double> distances(points.cols(), infinity);
  auto next = static_cast<std::size_t>(first);
  while (static_cast<Index>(picks.indices.size()) < count && distances[next] > 0) {
    picks.indices.push_back(static_cast<Index>(next));
    picks.radii.push_back(std::sqrt(distances[next]));
    const Point<Dim> pick = points.col(static_cast<Index>(next));
    for (std::size_t i = 0; i < distances.size(); ++i)
      distances[i] = std::min(distances[i], squared_distance<Dim>(points.col(static_cast<Index>(i)), pick));
    next = static_cast<std::size_t>(std::max_element(distances.begin(), distances.end()) - distances.begin());
  }
  picks.covering_radius = std::sqrt(distances[next]);
  return picks;
}

template <class T>
class FarthestPointsIn : public testing::Test {};
TYPED_TEST_SUITE(FarthestPointsIn, Dimensions);

TEST(FarthestPoints, BisectALine) {
  Points<1> line(1, 9);
  line << 0, 1, 2, 3, 4, 5, 6, 7, 8;
  const FarthestPoints picks = farthest_points<1>(line, 5);
  EXPECT_EQ(picks.indices, (std::vector<Index>{0, 8, 4, 2, 6}));
  EXPECT_EQ(picks.radii, (std::vector<double>{infinity, 8, 4, 2, 2}));
  EXPECT_EQ(picks.covering_radius, 1);
}

TEST(FarthestPoints, StartAtTheMinCornerUnlessToldOtherwise) {
  Points<2> points(2, 4);
  points << 3, 1, 0, 3,  //
      3, 1, 3, 0;
  EXPECT_EQ(farthest_points<2>(points, 1).indices, std::vector<Index>{1});
  EXPECT_EQ(farthest_points<2>(points, 1, {.first = 2}).indices, std::vector<Index>{2});
}

TEST(FarthestPoints, BreakTiesByTheSmallestIndex) {
  Points<2> square(2, 4);
  square << 1, 0, 1, 0,  //
      0, 1, 1, 0;
  EXPECT_EQ(farthest_points<2>(square, 4).indices, (std::vector<Index>{3, 2, 0, 1}));
  Points<1> pair(1, 3);
  pair << 5, 5, 6;
  EXPECT_EQ(farthest_points<1>(pair, 2).indices, (std::vector<Index>{0, 2}));
}

TYPED_TEST(FarthestPointsIn, AreThoseOfTheDirectMethod) {
  constexpr int Dim = TypeParam::value;
  for (const Index n : {1, 2, 17, 300, 2000}) {
    for (const auto& [name, points] : point_sets<Dim>(n)) {
      const Index first = farthest_points<Dim>(points, 1).indices[0];
      const FarthestPoints expected = brute_force<Dim>(points, 250, first);
      const FarthestPoints picks = farthest_points<Dim>(points, 250);
      EXPECT_EQ(picks.indices, expected.indices) << name;
      ASSERT_EQ(picks.radii.size(), expected.radii.size()) << name;
      for (std::size_t i = 0; i < picks.radii.size(); ++i) EXPECT_DOUBLE_EQ(picks.radii[i], expected.radii[i]) << name;
      EXPECT_DOUBLE_EQ(picks.covering_radius, expected.covering_radius) << name;
    }
  }
}

TYPED_TEST(FarthestPointsIn, AreSeparatedByAndCoverWithinTheLastRadius) {
  constexpr int Dim = TypeParam::value;
  for (const auto& [name, points] : point_sets<Dim>(1500)) {
    const FarthestPoints picks = farthest_points<Dim>(points, 60);
    EXPECT_TRUE(std::is_sorted(picks.radii.rbegin(), picks.radii.rend())) << name;
    EXPECT_LE(picks.covering_radius, picks.radii.back()) << name;
    double separation = infinity;
    for (const Index i : picks.indices)
      for (const Index j : picks.indices)
        if (i != j) separation = std::min(separation, (points.col(i) - points.col(j)).norm());
    constexpr double rounding = 1e-12;
    EXPECT_TRUE(separation == picks.radii.back() || std::abs(separation - picks.radii.back()) < rounding) << name;
    double covering = 0;
    for (Index i = 0; i < points.cols(); ++i) {
      double nearest = infinity;
      for (const Index j : picks.indices) nearest = std::min(nearest, (points.col(i) - points.col(j)).norm());
      covering = std::max(covering, nearest);
    }
    EXPECT_NEAR(covering, picks.covering_radius, rounding) << name;
  }
}

TYPED_TEST(FarthestPointsIn, StopWhenEveryDistinctPointIsPicked) {
  constexpr int Dim = TypeParam::value;
  const Points<Dim> points = duplicated_points<Dim>(90, 8);
  const FarthestPoints picks = farthest_points<Dim>(points, 1000);
  EXPECT_EQ(picks.indices.size(), 30);
  EXPECT_GT(picks.radii.back(), 0);
  EXPECT_EQ(picks.covering_radius, 0);
}

TYPED_TEST(FarthestPointsIn, DoNotDependOnTheScaleOfThePoints) {
  constexpr int Dim = TypeParam::value;
  const Points<Dim> points = clustered_points<Dim>(500, 9);
  const FarthestPoints expected = farthest_points<Dim>(points, 100);
  for (const int exponent : {-900, -100, 100, 1000}) {
    const double scale = std::ldexp(1.0, exponent);
    const FarthestPoints picks = farthest_points<Dim>(Points<Dim>(scale * points), 100);
    EXPECT_EQ(picks.indices, expected.indices);
    EXPECT_EQ(picks.covering_radius, scale * expected.covering_radius);
  }
}

TEST(FarthestPoints, OfNothingAreNone) {
  EXPECT_TRUE(farthest_points<3>(Points<3>(3, 0), 10).indices.empty());
  EXPECT_TRUE(farthest_points<3>(uniform_points<3>(5, 1), 0).indices.empty());
}

TEST(FarthestPoints, CanBeCancelled) {
  const auto stop = [](std::string_view, double) { return false; };
  EXPECT_THROW(farthest_points<2>(uniform_points<2>(10, 1), 5, {.first = {}, .progress = stop}), Cancelled);
}

TEST(FarthestPoints, RejectCoordinatesThatAreNotFiniteAndIndicesOutOfRange) {
  Points<2> points = uniform_points<2>(5, 1);
  EXPECT_THROW(farthest_points<2>(points, -1), InvalidInput);
  EXPECT_THROW(farthest_points<2>(points, 2, {.first = 5}), InvalidInput);
  EXPECT_THROW(farthest_points<2>(points, 2, {.first = -1}), InvalidInput);
  points(1, 3) = std::numeric_limits<double>::quiet_NaN();
  try {
    farthest_points<2>(points, 2);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(),
                 "farthest_points: points = NaN or infinity: every coordinate must be finite; remove the others");
  }
}

}  // namespace
}  // namespace csrbf::farthest_points_test
