#include "csrbf/approx/unity/cover.hpp"

#include "approx/approx_testing.hpp"
#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"

#include <numeric>

namespace csrbf::cover_test {
namespace {

// The number of cells that x lies in, borders counted on the upper side only, and one of them.
template <int Dim>
std::pair<Index, Index> cells_at(const Cover<Dim>& cover, const Point<Dim>& x) {
  std::pair<Index, Index> found = {0, -1};
  for (Index i = 0; i < cover.size(); ++i) {
    const Box<Dim>& cell = cover.cell(i);
    if ((x.array() >= cell.lo.array()).all() && (x.array() < cell.hi.array()).all()) found = {found.first + 1, i};
  }
  return found;
}

template <int Dim>
void expect_tiling(const Points<Dim>& points, Index leaf_size) {
  const Cover<Dim> cover(points, leaf_size, 1.5);
  double volume = 0;
  for (Index i = 0; i < cover.size(); ++i) volume += cover.cell(i).extent().prod();
  EXPECT_NEAR(volume / cover.box().extent().prod(), 1, 1e-10) << Dim;
  const Points<Dim> unit = random_points<Dim>(100, 3);
  for (Index i = 0; i < unit.cols(); ++i) {
    const Point<Dim> x = cover.box().lo + unit.col(i).cwiseProduct(cover.box().extent());
    EXPECT_EQ(cells_at<Dim>(cover, x), std::make_pair(Index{1}, cover.find(x))) << Dim;
  }
  for (Index i = 0; i < std::min<Index>(points.cols(), 100); ++i)
    EXPECT_EQ(cells_at<Dim>(cover, points.col(i)).first, 1);
}

// A permutation of the input, cell by cell.
template <int Dim>
void expect_sorted_points(const Points<Dim>& points, Index leaf_size) {
  const Cover<Dim> cover(points, leaf_size, 1.5);
  std::vector<std::uint32_t> order = cover.order();
  Index next = 0;
  for (Index cell = 0; cell < cover.size(); ++cell)
    for (Index k = 0; k < cover.count(cell); ++k, ++next) {
      EXPECT_EQ(cover.points().col(next), points.col(order[next]));
      EXPECT_EQ(cover.find(cover.points().col(next)), cell);
    }
  EXPECT_EQ(next, points.cols());
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], i);
}

template <int Dim>
void expect_cover(const Points<Dim>& points, Index leaf_size) {
  expect_tiling<Dim>(points, leaf_size);
  expect_sorted_points<Dim>(points, leaf_size);
}

// Half of the points in a ball that is 1e6 times denser along each axis.
template <int Dim>
Points<Dim> clusters(Index count) {
  Points<Dim> points = random_points<Dim>(count, 1);
  points.leftCols(count / 2) = (.3 + 1e-6 * points.leftCols(count / 2).array()).matrix();
  return points;
}

// Pairs, 1e-15 apart.
template <int Dim>
Points<Dim> near_duplicates(Index count) {
  Points<Dim> points = random_points<Dim>(count, 1);
  points.leftCols(count / 2) = (points.rightCols(count / 2).array() + 1e-15).matrix();
  return points;
}

// The points of each cell, in the order of their numbers.
template <int Dim>
std::vector<std::vector<std::uint32_t>> members(const Cover<Dim>& cover) {
  std::vector<std::vector<std::uint32_t>> cells;
  Index next = 0;
  for (Index cell = 0; cell < cover.size(); next += cover.count(cell++)) {
    const auto first = cover.order().begin() + next;
    cells.emplace_back(first, first + cover.count(cell));
    std::sort(cells.back().begin(), cells.back().end());
  }
  return cells;
}

template <int Dim>
void expect_same_cover_of_sorted_points(const Points<Dim>& points) {
  constexpr Index leaf_size = 20;
  const Cover<Dim> direct(points, leaf_size, 1.5);
  for (const Index other : {1, 7, 20, 90, 1000}) {
    const Cover<Dim> again(Cover<Dim>(points, other, 1.5, CoverUse::fitting), leaf_size);
    EXPECT_EQ(again.tree().axis, direct.tree().axis) << other;
    EXPECT_EQ(again.tree().split, direct.tree().split) << other;
    EXPECT_EQ(again.tree().right, direct.tree().right) << other;
    EXPECT_EQ(members(again), members(direct)) << other;
    for (Index cell = 0; cell < direct.size(); ++cell)
      EXPECT_TRUE(std::ranges::equal(again.supports_over(cell), direct.supports_over(cell)));
    for (Index i = 0; i < points.cols(); ++i) EXPECT_EQ(again.points().col(i), points.col(again.order()[i]));
  }
}

TEST(Cover, IsTheSameWhenItsPointsWereSortedIntoOtherCells) {
  expect_same_cover_of_sorted_points<1>(random_points<1>(500, 1));
  expect_same_cover_of_sorted_points<2>(clusters<2>(500));
  expect_same_cover_of_sorted_points<3>(near_duplicates<3>(500));
}

TEST(Cover, PutsRowsOfNumbersInTheOrderOfItsPoints) {
  const Points<2> points = random_points<2>(50000, 1);
  const Cover<2> cover(points, 20, 1.5);
  EXPECT_EQ(cover.in_order(points.transpose()), cover.points().transpose());
  EXPECT_EQ(cover.in_order(Eigen::MatrixXd(0, 1)).rows(), 0);
  EXPECT_EQ(invalid_input_message([&] { (void)cover.in_order(Eigen::VectorXd::Zero(49999)); }),
            "Cover::in_order: rows = 49999: there must be one per point, or none at all");
}

TEST(Cover, TilesTheBoxOfItsPointsWithCells) {
  expect_cover<1>(random_points<1>(500, 1), 7);
  expect_cover<2>(random_points<2>(500, 1), 7);
  expect_cover<3>(random_points<3>(500, 1), 7);
  expect_cover<4>(random_points<4>(500, 1), 7);
  expect_cover<5>(random_points<5>(500, 1), 7);
  expect_cover<6>(random_points<6>(500, 1), 7);
  expect_cover<3>(random_points<3>(500, 1), 1);
  expect_cover<3>(random_points<3>(500, 1), 500);
  expect_cover<2>(clusters<2>(500), 5);
  expect_cover<2>(near_duplicates<2>(500), 1);
  expect_cover<3>(1e-30 * random_points<3>(500, 1), 7);
  expect_cover<3>(1e30 * random_points<3>(500, 1), 7);
}

TEST(Cover, TilesTheBoxOfCoincidentCoordinates) {
  Points<3> plane = random_points<3>(300, 1);
  plane.row(1).setConstant(7);
  expect_cover<3>(plane, 10);
  plane.row(2).setConstant(-1e10);  // rounding is larger than the margin
  expect_cover<3>(plane, 10);
  Points<2> grid = (random_points<2>(400, 1) * 5).array().floor().matrix();  // 16 points at each place, too many
  expect_cover<2>(grid, 3);
  expect_cover<2>(Points<2>::Constant(2, 40, 3), 3);
  expect_cover<2>((1e10 + 1e-3 * random_points<2>(200, 1).array()).matrix(), 1);  // few coordinates are left
  expect_cover<2>(Points<2>::Zero(2, 1), 3);
}

TEST(Cover, HoldsAtMostTheLeafSizeInACellOfCompactShape) {
  const Cover<3> cover(clusters<3>(20000), 20, 1.5);
  for (Index i = 0; i < cover.size(); ++i) {
    EXPECT_LE(cover.count(i), 20);
    const Point<3> extent = cover.cell(i).extent();
    EXPECT_LE(extent.maxCoeff(), extent.minCoeff() / .3 * 1.01);
  }
}

template <int Dim>
void expect_supports(const Points<Dim>& points, Index leaf_size, double growth) {
  const Cover<Dim> cover(points, leaf_size, growth);
  EXPECT_EQ(cover.growth(), growth);
  for (Index cell = 0; cell < cover.size(); ++cell) {
    std::vector<std::uint32_t> expected;
    for (Index i = 0; i < cover.size(); ++i) {
      const Point<Dim> half = 0.5 * growth * cover.cell(i).extent(), center = cover.cell(i).center();
      const Point<Dim> lo = center - half, hi = center + half;
      if ((lo.array() < cover.cell(cell).hi.array()).all() && (hi.array() > cover.cell(cell).lo.array()).all())
        expected.push_back(static_cast<std::uint32_t>(i));
    }
    const auto found = cover.supports_over(cell);
    EXPECT_EQ(std::vector<std::uint32_t>(found.begin(), found.end()), expected) << Dim;
  }
}

TEST(Cover, KnowsTheSupportsOverACell) {
  expect_supports<1>(random_points<1>(300, 1), 4, 2);
  expect_supports<2>(random_points<2>(300, 1), 4, 1.7);
  expect_supports<3>(random_points<3>(300, 1), 4, 1.5);
  expect_supports<4>(random_points<4>(300, 1), 4, 1.1);
  expect_supports<5>(random_points<5>(300, 1), 4, 1.3);
  expect_supports<6>(random_points<6>(300, 1), 4, 1.3);
  expect_supports<2>(clusters<2>(300), 4, 3);
}

template <int Dim>
void expect_nearest(const Cover<Dim>& cover, const Point<Dim>& x, Index n, double reach) {
  const Points<Dim>& points = cover.points();
  typename Cover<Dim>::Search search;
  cover.nearest(x, n, reach, search);
  std::vector<double> expected(points.cols());
  for (Index i = 0; i < points.cols(); ++i) expected[i] = (points.col(i) - x).squaredNorm();
  std::sort(expected.begin(), expected.end());
  expected.resize(std::min(n, points.cols()));
  ASSERT_EQ(search.found.size(), expected.size());
  std::vector<std::uint32_t> ids;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(search.found[k].first, expected[k]);
    EXPECT_EQ(search.found[k].first, (points.col(search.found[k].second) - x).squaredNorm());
    ids.push_back(search.found[k].second);
  }
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(std::unique(ids.begin(), ids.end()), ids.end());
}

template <int Dim>
void expect_nearest(const Points<Dim>& points) {
  const Box<Dim> box = bounding_box<Dim>(points);
  const double size = box.diagonal();
  const Points<Dim> unit = random_points<Dim>(6, 3);
  const Cover<Dim> cover(points, 6, 1.5);
  for (const double reach : {0.0, 1e-3 * size, size, 1e9 * size})
    for (const Index n : {Index{1}, Index{17}, points.cols() + 3}) {
      for (Index i = 0; i < unit.cols(); ++i)
        expect_nearest<Dim>(cover, box.lo + unit.col(i).cwiseProduct(box.extent()), n, reach);
      expect_nearest<Dim>(cover, points.col(3), n, reach);
    }
}

TEST(Cover, FindsTheNearestPoints) {
  expect_nearest<1>(random_points<1>(300, 1));
  expect_nearest<2>(random_points<2>(300, 1));
  expect_nearest<3>(random_points<3>(300, 1));
  expect_nearest<4>(random_points<4>(300, 1));
  expect_nearest<5>(random_points<5>(300, 1));
  expect_nearest<6>(random_points<6>(300, 1));
  expect_nearest<2>(clusters<2>(300));
  expect_nearest<3>(clusters<3>(300));
  expect_nearest<2>(near_duplicates<2>(300));
  expect_nearest<2>(1e-30 * random_points<2>(300, 1));
  expect_nearest<2>(1e30 * random_points<2>(300, 1));
  expect_nearest<3>(Points<3>::Constant(3, 20, 5));
}

TEST(Cover, FindsTheNearestPointsOfLargeClusters) {
  Points<2> points = random_points<2>(20000, 1);
  points.leftCols(19000) *= 1e-3;
  const Cover<2> cover(points, 6, 1.5);
  for (const double reach : {1e-6, 1e-3, .5, 2.0})
    for (const Index n : {1, 50, 700}) {
      expect_nearest<2>(cover, Point<2>(.9, .8), n, reach);
      expect_nearest<2>(cover, Point<2>(-.1, -.2), n, reach);
      expect_nearest<2>(cover, Point<2>(5e-4, 3e-4), n, reach);
    }
}

TEST(Cover, KnowsWhetherAPointIsNear) {
  const Points<3> points = clusters<3>(300), asked = random_points<3>(100, 2);
  const Cover<3> cover(points, 6, 1.5);
  for (Index k = 0; k < asked.cols(); ++k) {
    double nearest = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < points.cols(); ++i) nearest = std::min(nearest, (points.col(i) - asked.col(k)).norm());
    EXPECT_TRUE(cover.any_within(asked.col(k), 1.000001 * nearest));
    EXPECT_FALSE(cover.any_within(asked.col(k), .999999 * nearest));
  }
}

TEST(Cover, FindsTheNearestPointsFromFarAway) {
  const Cover<3> cover(random_points<3>(300, 1), 6, 1.5);
  for (const double distance : {10.0, 1e3, 1e8, 1e16, 1e20, 1e100})
    for (const Index n : {1, 5, 400}) expect_nearest<3>(cover, Point<3>(distance, -2 * distance, .3), n, .1);
}

TEST(Cover, FindsACellForPointsOutsideTheBox) {
  const Cover<2> cover(random_points<2>(300, 1), 5, 1.5);
  const Points<2> inside = random_points<2>(50, 3);
  for (Index i = 0; i < inside.cols(); ++i) {
    Point<2> outside = inside.col(i);
    Point<2> edge = outside;
    outside[0] = 1e9;
    edge[0] = cover.box().hi[0];
    EXPECT_EQ(cover.find(outside), cover.find(edge));
  }
}

TEST(Cover, ComesBackFromItsTree) {
  const Cover<3> cover(clusters<3>(2000), 9, 1.5);
  const Cover<3> copy(cover.tree());
  ASSERT_EQ(copy.size(), cover.size());
  EXPECT_EQ(copy.growth(), cover.growth());
  EXPECT_EQ(copy.box().lo, cover.box().lo);
  for (Index i = 0; i < cover.size(); ++i) {
    EXPECT_EQ(copy.cell(i).lo, cover.cell(i).lo);
    EXPECT_EQ(copy.cell(i).hi, cover.cell(i).hi);
    const auto a = copy.supports_over(i), b = cover.supports_over(i);
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
  }
  const Points<3> x = random_points<3>(200, 3);
  for (Index i = 0; i < x.cols(); ++i) EXPECT_EQ(copy.find(x.col(i)), cover.find(x.col(i)));
}

TEST(Cover, DoesNotDependOnTheNumberOfThreads) {
  const Points<2> points = random_points<2>(20000, 1);
  set_thread_count(1);
  const Cover<2> one(points, 5, 1.7);
  set_thread_count(2);
  const Cover<2> two(points, 5, 1.7);
  set_thread_count(0);
  EXPECT_EQ(one.order(), two.order());
  EXPECT_EQ(one.tree().split, two.tree().split);
}

TEST(Cover, RefusesBadInput) {
  const Points<2> points = random_points<2>(10, 1);
  expect_refusal([&] { Cover<2>(Points<2>(2, 0), 5, 1.5); }, "Cover: points = 0: at least one is needed");
  expect_refusal([&] { Cover<2>(points, 0, 1.5); }, "Cover: leaf_size = 0: must be at least 1");
  expect_refusal([&] { Cover<2>(points, 5, 1); }, "Cover: growth = 1: must be above 1, so that supports overlap");
  expect_refusal([&] { Cover<2>(points, 5, std::nan("")); },
                 "Cover: growth = nan: must be above 1, so that supports overlap");
}

}  // namespace
}  // namespace csrbf::cover_test
