#include "csrbf/implicit/rays/candidate_cells.hpp"

#include "implicit/analytic_fields.hpp"

#include <Eigen/Geometry>

namespace csrbf::candidate_cells_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// 1 - sum a_k (x_k - c_k)^2 with exact bounds of values and slopes on boxes.
class EnclosedEllipsoid : public AnalyticField {
 public:
  EnclosedEllipsoid(const Point<3>& half, const Point<3>& c, const Box<3>& bounds)
      : AnalyticField(ellipsoid(half, c)), a_(half.array().square().inverse()), c_(c), bounds_(bounds) {}

  [[nodiscard]] Box<3> bounds() const override { return bounds_; }
  [[nodiscard]] std::optional<Enclosure> enclose(const Box<3>& box) const override {
    const Point<3> nearest = c_.cwiseMax(box.lo).cwiseMin(box.hi) - c_;
    const Point<3> farthest = (box.lo - c_).cwiseAbs().cwiseMax((box.hi - c_).cwiseAbs());
    return Enclosure{1 - a_.dot(farthest.cwiseAbs2()), 1 - a_.dot(nearest.cwiseAbs2()),
                     2 * a_.cwiseProduct(farthest).norm(), 2 * a_.maxCoeff()};
  }

 private:
  Point<3> a_, c_;
  Box<3> bounds_;
};

// The cells that enclosures do not exclude, one by one, and the stretches of rays through them.
struct PlainCells {
  PlainCells(const Field<3>& field, double given_side)
      : side(given_side), origin(field.bounds().lo.array() - 4 * side) {
    size = (field.bounds().extent() / side - Point<3>::Constant(1e-9)).array().ceil().cast<int>() + 8;
    for (int z = 0; z < size[2]; ++z)
      for (int y = 0; y < size[1]; ++y)
        for (int x = 0; x < size[0]; ++x) {
          const Point<3> lo = origin + side * Point<3>(x, y, z);
          cells.push_back(field.enclose(Box<3>{lo, lo.array() + side}.inflated(1e-6 * side)).value());
        }
  }

  [[nodiscard]] static bool kept(const Enclosure& cell) { return cell.lo <= 0 && cell.hi >= 0; }

  [[nodiscard]] Index count() const { return std::count_if(cells.begin(), cells.end(), kept); }

  // Between the places where the ray meets a wall.
  [[nodiscard]] std::vector<Stretch> stretches(const Ray& ray, double t_max) const {
    std::vector<double> walls{0};
    for (Index k = 0; k < 3; ++k)
      for (int i = 0; i <= size[k] && ray.direction[k] != 0; ++i)
        walls.push_back((origin[k] + side * i - ray.origin[k]) / ray.direction[k]);
    std::sort(walls.begin(), walls.end());
    std::vector<Stretch> found;
    int length = 0;
    for (std::size_t i = 0; i + 1 < walls.size(); ++i) {
      if (walls[i] < 0 || walls[i] >= t_max) continue;
      const Point<3> middle = ray.origin + 0.5 * (walls[i] + walls[i + 1]) * ray.direction;
      const Eigen::Array3i cell = ((middle - origin) / side).array().floor().cast<int>();
      const bool in_lattice = (cell >= 0).all() && (cell < size).all();
      const Enclosure* here = in_lattice ? &cells[cell[0] + size[0] * (cell[1] + size[1] * cell[2])] : nullptr;
      if (here == nullptr || !kept(*here)) {
        length = 0;
        continue;
      }
      if (length == 4) length = 0;  // the longest stretch
      if (length++ == 0) found.push_back({walls[i], walls[i], 0, 0});
      found.back().end = std::min(walls[i + 1], t_max);
      found.back().lipschitz = std::max(found.back().lipschitz, here->lipschitz);
      found.back().hessian_bound = std::max(found.back().hessian_bound, here->hessian_bound);
    }
    return found;
  }

  double side;
  Point<3> origin;
  Eigen::Array3i size;
  std::vector<Enclosure> cells;
};

std::vector<Stretch> walk(const CandidateCells& cells, const Ray& ray, double t_max = infinity) {
  std::vector<Stretch> found;
  CandidateCells::Walk walk;
  for (Stretch stretch; cells.next(ray, t_max, walk, stretch);) found.push_back(stretch);
  return found;
}

void expect_stretches(const CandidateCells& cells, const PlainCells& plain, const Ray& ray, double t_max) {
  constexpr double rounding = 1e-11, single = 1e-6;
  const std::vector<Stretch> found = walk(cells, ray, t_max), expected = plain.stretches(ray, t_max);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].begin, expected[i].begin, rounding);
    EXPECT_NEAR(found[i].end, expected[i].end, rounding);
    EXPECT_GE(found[i].lipschitz, expected[i].lipschitz);
    EXPECT_LE(found[i].lipschitz, expected[i].lipschitz * (1 + single));
    EXPECT_GE(found[i].hessian_bound, expected[i].hessian_bound);
    EXPECT_LE(found[i].hessian_bound, expected[i].hessian_bound * (1 + single));
  }
}

// The surface reaches three cells beyond the bounds, of the four that the lattice adds.
EnclosedEllipsoid beyond_its_bounds(double side) {
  const Point<3> c(0.11, -0.07, 0.23), half(1.9, 1.1, 0.8);
  return {half, c, {(c - half).array() + 3 * side, (c + half).array() - 3 * side}};
}

TEST(CandidateCells, AreThoseThatEnclosuresDoNotExclude) {
  for (const int resolution : {9, 24, 50}) {
    const double side = 3.8 / (resolution + 6);
    const EnclosedEllipsoid field = beyond_its_bounds(side);
    const CandidateCells cells(field, resolution, Mesh(), {});
    const PlainCells plain(field, side);
    EXPECT_TRUE(cells.guaranteed());
    EXPECT_NEAR(cells.side(), side, 1e-12);
    EXPECT_EQ(cells.size(), plain.count()) << resolution;
  }
}

TEST(CandidateCells, AreAtMost64AlongTheLongestSideWithEnclosures) {
  const EnclosedEllipsoid field({1, 1, 1}, Point<3>::Zero(), box_around(Point<3>::Zero(), Point<3>(1, 0.5, 0.2)));
  EXPECT_EQ(CandidateCells(field, 63, Mesh(), {}).side(), 2.0 / 63);
  EXPECT_EQ(CandidateCells(field, 64, Mesh(), {}).side(), 2.0 / 64);
  EXPECT_EQ(CandidateCells(field, 500, Mesh(), {}).side(), 2.0 / 64);
}

TEST(CandidateCells, GiveTheStretchesOfRaysThroughThem) {
  const double side = 3.8 / 30;
  const EnclosedEllipsoid field = beyond_its_bounds(side);
  const CandidateCells cells(field, 24, Mesh(), {});
  const PlainCells plain(field, side);
  const Points<3> targets = random_points_in(field.bounds(), 300, 1), directions = random_directions(300, 2);
  for (Index i = 0; i < 300; ++i) {
    Ray ray{targets.col(i), directions.col(i)};
    if (i % 3 != 0) ray.origin -= 5 * ray.direction;  // else from inside
    expect_stretches(cells, plain, ray, infinity);
    expect_stretches(cells, plain, ray, 4.9);
  }
  for (Index i = 0; i < 60; ++i) {  // along an axis or a plane
    Ray ray{targets.col(i), directions.col(i)};
    ray.direction[i % 3] = 0;
    if (i % 2 == 0) ray.direction[(i + 1) % 3] = 0;
    ray.direction.normalize();
    if (i % 4 != 0) ray.origin -= 5 * ray.direction;
    expect_stretches(cells, plain, ray, infinity);
    ray.origin[i % 3] += i % 2 == 0 ? 9 : -9;  // beside the lattice
    EXPECT_TRUE(walk(cells, ray).empty());
  }
}

TEST(CandidateCells, GiveNothingToRaysThatMissTheLattice) {
  const EnclosedEllipsoid field = beyond_its_bounds(0.1);
  const CandidateCells cells(field, 32, Mesh(), {});
  const Points<3> directions = random_directions(50, 3);
  for (Index i = 0; i < 50; ++i) {
    const Point<3> d = directions.col(i);
    EXPECT_TRUE(walk(cells, {5 * d, d}).empty());                   // behind the origin
    EXPECT_TRUE(walk(cells, {5 * d, d.unitOrthogonal()}).empty());  // beside it
  }
}

Mesh triangle(const Point<3>& a, const Point<3>& b, const Point<3>& c) {
  Mesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << a, b, c;
  mesh.triangles.resize(3, 1);
  mesh.triangles << 0, 1, 2;
  return mesh;
}

const Box<3> unit{Point<3>::Zero(), Point<3>::Ones()};
constexpr int tenths = 10;  // cells of 0.1

// Far from zero, so that they do not spread.
TEST(CandidateCells, AreNextToTheVerticesOfAMeshWithoutEnclosures) {
  const AnalyticField field([](const AnalyticField::Variables& x) { return 100.0 + 2.0 * x[2]; }, unit);
  const Point<3> near(0.55, 0.55, 0.55);
  EXPECT_EQ(CandidateCells(field, tenths, triangle(near, near, near), {}).size(), 27);
  EXPECT_EQ(CandidateCells(field, tenths, triangle(near, {0.65, 0.55, 0.55}, {0.55, 0.55, 0.95}), {}).size(),
            27 + 9 + 27);
  const CandidateCells cells(field, tenths, triangle(near, near, near), {});
  EXPECT_FALSE(cells.guaranteed());
  for (int axis = 0; axis < 3; ++axis) {
    const auto along = walk(cells, {near - 3 * Point<3>::Unit(axis), Point<3>::Unit(axis)});
    ASSERT_EQ(along.size(), 1U);
    EXPECT_NEAR(along[0].begin, 3.05 - 0.2, 1e-12);
    EXPECT_NEAR(along[0].end, 3.05 + 0.1, 1e-12);
  }
}

// In the cells around a vertex: at least what was seen, at most a fifth more and what a bend of the slope adds.
TEST(CandidateCells, EstimateBoundsFromDerivativesAtVertices) {
  constexpr double side = 0.1, slope = 3, bend = 7;
  const Point<3> p(0.55, 0.55, 0.55);
  const AnalyticField field(
      [=](const AnalyticField::Variables& x) {
        return 100.0 + slope * x[2] + (0.5 * bend) * ((x[0] - p[0]) * (x[0] - p[0]));
      },
      unit);
  const CandidateCells cells(field, tenths, triangle(p, p, p), {});
  const auto along = walk(cells, {p - 3 * Point<3>::UnitY(), Point<3>::UnitY()});
  ASSERT_EQ(along.size(), 1U);
  const double least_bend = 0.1 * slope / side;  // of any estimate
  EXPECT_NEAR(along[0].hessian_bound, 2 * bend + least_bend, 1e-5);
  EXPECT_NEAR(along[0].lipschitz, slope + along[0].hessian_bound * 2 * side, 1e-5);  // no cell ends further away
}

// |x - 1/2| has no second derivatives but a crease.
TEST(CandidateCells, SeeCreasesBetweenVertices) {
  const AnalyticField field(
      [](const AnalyticField::Variables& x) { return x[0].value > 0.5 ? 100.0 + x[0] : 101.0 - x[0]; }, unit);
  const auto bend_at = [&](const Mesh& mesh) {
    const auto along = walk(CandidateCells(field, tenths, mesh, {}), {{-3, 0.55, 0.55}, Point<3>::UnitX()});
    return along.empty() ? 0 : along[0].hessian_bound;
  };
  const double flat = bend_at(triangle({0.52, 0.55, 0.55}, {0.58, 0.55, 0.55}, {0.55, 0.57, 0.55}));
  EXPECT_NEAR(flat, 1, 1e-5);
  // A jump of two over 0.25; over less than a tenth of a cell it counts as over that.
  EXPECT_NEAR(bend_at(triangle({0.45, 0.55, 0.55}, {0.7, 0.55, 0.55}, {0.7, 0.55, 0.55})), flat + 2 * 2 / 0.25, 1e-4);
  EXPECT_NEAR(bend_at(triangle({0.4995, 0.55, 0.55}, {0.5005, 0.55, 0.55}, {0.5005, 0.55, 0.55})), flat + 2 * 2 / 0.01,
              1e-2);
}

// A triangle of a plane is enough to find all of it, and little more than it.
TEST(CandidateCells, SpreadOverASurfaceOfWhichAPartIsKnown) {
  for (const double height : {0.501, 0.53, 0.55, 0.58}) {
    const AnalyticField field([=](const AnalyticField::Variables& x) { return 3.0 * (x[2] - height); }, unit);
    const Mesh mesh = triangle({0.31, 0.32, height}, {0.33, 0.32, height}, {0.31, 0.35, height});
    const CandidateCells cells(field, tenths, mesh, {});
    const Points<3> starts = random_points_in({{-0.39, -0.39, 2}, {1.39, 1.39, 2}}, 200, 4);
    for (Index i = 0; i < starts.cols(); ++i) {
      const auto along = walk(cells, {starts.col(i), -Point<3>::UnitZ()});
      ASSERT_EQ(along.size(), 1U);
      EXPECT_LT(along[0].begin, 2 - height);
      EXPECT_GT(along[0].end, 2 - height);
      EXPECT_LT(along[0].end - along[0].begin, 0.31);  // three layers
      EXPECT_GE(along[0].lipschitz, 3);
      EXPECT_LE(along[0].lipschitz, 1.2 * 3 * (1 + 1e-6));
    }
  }
}

// Of two planes with a layer of excluded cells between them, the one that the mesh does not know stays out of reach.
TEST(CandidateCells, DoNotSpreadBeyondExcludedCells) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const double known = 0.5 - 0.25 * sign, other = 0.5 + 0.08 * sign;
      const AnalyticField field(
          [=](const AnalyticField::Variables& x) { return (x[axis] - known) * (x[axis] - other); }, unit);
      const Point<3> ahead = sign * Point<3>::Unit(axis), aside = Point<3>::Ones() - Point<3>::Unit(axis);
      const Point<3> p = 0.55 * aside + known * Point<3>::Unit(axis);
      const CandidateCells cells(field, tenths, triangle(p, p, p), {});
      for (const double shift : {-0.4, 0.0, 0.4}) {
        const auto along = walk(cells, {p + shift * aside - 3 * ahead, ahead});
        ASSERT_FALSE(along.empty());
        EXPECT_NEAR(along.back().end, 3 + 0.15, 1e-12);
      }
    }
}

TEST(CandidateCells, ReportHowFarTheyAre) {
  const EnclosedEllipsoid known = beyond_its_bounds(0.1);
  const AnalyticField plain([](const AnalyticField::Variables& x) { return x[2] - 0.53; }, unit);
  const Mesh mesh = triangle({0.31, 0.32, 0.53}, {0.33, 0.32, 0.53}, {0.31, 0.35, 0.53});
  for (const Field<3>* field : {static_cast<const Field<3>*>(&known), static_cast<const Field<3>*>(&plain)}) {
    std::vector<double> fractions;
    const auto listen = [&](std::string_view stage, double fraction) {
      EXPECT_EQ(stage, "cells");
      return fractions.push_back(fraction), true;
    };
    const CandidateCells cells(*field, tenths, mesh, listen);
    EXPECT_GT(fractions.size(), 3U);
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
    EXPECT_EQ(fractions.front(), 0);
    EXPECT_EQ(fractions.back(), 1);
  }
}

}  // namespace
}  // namespace csrbf::candidate_cells_test
