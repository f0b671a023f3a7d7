#include "csrbf/spatial/bounded_voronoi.hpp"

#include "csrbf/core/error.hpp"
#include "spatial/spatial_testing.hpp"

#include <Eigen/LU>

namespace csrbf::bounded_voronoi_test {
namespace {

constexpr double rounding = 1e-11;  // corners are solutions of small, at times nearly singular systems

template <int Dim>
Box<Dim> cube() {
  return {Point<Dim>::Constant(-1), Point<Dim>::Constant(1)};
}

// Half-spaces normal . x <= offset whose intersection is the cell of centre i in the box.
template <int Dim>
void half_spaces(const Points<Dim>& centers, Index i, const Box<Dim>& box, std::vector<Point<Dim>>& normals,
                 std::vector<double>& offsets) {
  for (Index j = 0; j < centers.cols(); ++j) {
    const Point<Dim> to = centers.col(j) - centers.col(i);
    if (to.norm() == 0) continue;
    normals.push_back(to.normalized());
    offsets.push_back(normals.back().dot(centers.col(i) + 0.5 * to));
  }
  for (int axis = 0; axis < Dim; ++axis) {
    normals.push_back(Point<Dim>::Unit(axis));
    offsets.push_back(box.hi[axis]);
    normals.push_back(-Point<Dim>::Unit(axis));
    offsets.push_back(-box.lo[axis]);
  }
}

// Largest distance to a corner of the cell, found by trying every set of Dim planes.
template <int Dim>
double scale_of_all_corners(const Points<Dim>& centers, Index i, const Box<Dim>& box) {
  std::vector<Point<Dim>> normals;
  std::vector<double> offsets;
  half_spaces<Dim>(centers, i, box, normals, offsets);
  double largest = 0;
  std::vector<bool> chosen(normals.size(), false);
  std::fill_n(chosen.begin(), Dim, true);
  do {
    Eigen::Matrix<double, Dim, Dim> A;
    Point<Dim> b;
    for (std::size_t plane = 0, row = 0; plane < chosen.size(); ++plane) {
      if (!chosen[plane]) continue;
      A.row(static_cast<Index>(row)) = normals[plane].transpose();
      b[static_cast<Index>(row++)] = offsets[plane];
    }
    if (std::abs(A.determinant()) < 1e-9) continue;
    const Point<Dim> corner = A.inverse() * b;
    bool inside = true;
    for (std::size_t plane = 0; plane < normals.size(); ++plane)
      inside = inside && normals[plane].dot(corner) <= offsets[plane] + 1e-9;
    if (inside) largest = std::max(largest, (corner - centers.col(i)).norm());
  } while (std::prev_permutation(chosen.begin(), chosen.end()));
  return largest;
}

template <class T>
class BoundedVoronoiIn : public testing::Test {};
using UpToFour = testing::Types<InDimension<1>, InDimension<2>, InDimension<3>, InDimension<4>>;
TYPED_TEST_SUITE(BoundedVoronoiIn, UpToFour);

TEST(BoundedVoronoi, MeasuresIntervalsOnALine) {
  Points<1> centers(1, 3);
  centers << 0, 1, 4;
  const Eigen::VectorXd scales = bounded_voronoi_scales<1>(centers, {Point<1>(-2), Point<1>(5)});
  EXPECT_NEAR(scales[0], 2, rounding);
  EXPECT_NEAR(scales[1], 1.5, rounding);
  EXPECT_NEAR(scales[2], 1.5, rounding);
}

TEST(BoundedVoronoi, MeasuresTheCellsOfAGridThoughFourOfThemMeetInEveryCorner) {
  Points<2> centers(2, 25);
  for (Index i = 0; i < 25; ++i) centers.col(i) << static_cast<double>(i % 5), static_cast<double>(i / 5);
  const Eigen::VectorXd scales = bounded_voronoi_scales<2>(centers, {Point<2>::Constant(-.5), Point<2>::Constant(4.5)});
  for (const double scale : scales) EXPECT_NEAR(scale, std::sqrt(.5), rounding);
}

TYPED_TEST(BoundedVoronoiIn, FindsTheCornersOfTheIntersectionOfAllHalfSpaces) {
  constexpr int Dim = TypeParam::value;
  for (const Index n : {1, 2, 3, 7}) {
    for (const auto& [name, points] : point_sets<Dim>(n)) {
      Box<Dim> box = bounding_box<Dim>(points);
      box = box.inflated(.25);
      const Eigen::VectorXd scales = bounded_voronoi_scales<Dim>(points, box);
      for (Index i = 0; i < n; ++i)
        EXPECT_NEAR(scales[i], scale_of_all_corners<Dim>(points, i, box), 1e-7 * box.diagonal()) << name << " " << i;
    }
  }
}

TYPED_TEST(BoundedVoronoiIn, CoversTheBoxByBallsAndHasTheFillDistanceAsLargestScale) {
  constexpr int Dim = TypeParam::value;
  const Points<Dim> centers = uniform_points<Dim>(100, 5);
  const Eigen::VectorXd scales = bounded_voronoi_scales<Dim>(centers, cube<Dim>());
  double fill = 0;
  const Points<Dim> x = uniform_points<Dim>(20000, 6);
  for (Index q = 0; q < x.cols(); ++q) {
    Index nearest = 0;
    const double distance = std::sqrt((centers.colwise() - x.col(q)).colwise().squaredNorm().minCoeff(&nearest));
    EXPECT_LE(distance, scales[nearest] + rounding);
    fill = std::max(fill, distance);
  }
  EXPECT_LE(fill, scales.maxCoeff() + rounding);
  EXPECT_GE(fill, .7 * scales.maxCoeff());
}

TYPED_TEST(BoundedVoronoiIn, ScalesWithTheDataFromTinyToHuge) {
  constexpr int Dim = TypeParam::value;
  const Points<Dim> centers = uniform_points<Dim>(30, 7);
  const Eigen::VectorXd scales = bounded_voronoi_scales<Dim>(centers, cube<Dim>());
  for (const double factor : {1e-200, 1e200}) {
    const Points<Dim> scaled = factor * centers;
    const Eigen::VectorXd found =
        bounded_voronoi_scales<Dim>(scaled, {factor * cube<Dim>().lo, factor * cube<Dim>().hi});
    for (Index i = 0; i < 30; ++i) EXPECT_NEAR(found[i] / factor, scales[i], rounding);
  }
}

TYPED_TEST(BoundedVoronoiIn, IsBoundedBelowByItsDiscreteVariant) {
  constexpr int Dim = TypeParam::value;
  const Points<Dim> centers = uniform_points<Dim>(50, 8);
  const Points<Dim> points = uniform_points<Dim>(5000, 9);
  const Eigen::VectorXd exact = bounded_voronoi_scales<Dim>(centers, cube<Dim>());
  const Eigen::VectorXd discrete = discrete_voronoi_scales<Dim>(centers, points);
  for (Index i = 0; i < 50; ++i) EXPECT_LE(discrete[i], exact[i] + rounding);
}

TEST(BoundedVoronoi, GivesCoincidingCentresTheSameCell) {
  Points<2> centers(2, 3);
  centers << -.5, -.5, .5, 0, 0, 0;
  const Eigen::VectorXd scales = bounded_voronoi_scales<2>(centers, cube<2>());
  for (const double scale : scales) EXPECT_NEAR(scale, std::sqrt(1.25), rounding);
}

TEST(BoundedVoronoi, RefusesCentresOutsideTheBox) {
  Points<2> centers(2, 2);
  centers << 0, 2, 0, 0;
  try {
    bounded_voronoi_scales<2>(centers, cube<2>());
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "bounded_voronoi_scales: centers = 1: is the index of a centre outside the box");
  }
  EXPECT_THROW(discrete_voronoi_scales<2>(Points<2>(2, 0), centers), InvalidInput);
}

}  // namespace
}  // namespace csrbf::bounded_voronoi_test
