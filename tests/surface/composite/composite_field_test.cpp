#include "csrbf/surface/composite/composite_field.hpp"

#include "csrbf/core/parallel.hpp"
#include "surface/composite_field_testing.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace csrbf::composite_field_test {
namespace {

// The winding number's error, and its jumps from cube to cube, in units of the far value.
constexpr double winding_error = 2e-3;

struct Shape {
  std::string name;
  PointCloud cloud;
  double area;
  std::function<double(const Point<3>&)> depth;  // distance to the surface, positive inside

  [[nodiscard]] double spacing() const { return std::sqrt(area / static_cast<double>(cloud.size())); }
  [[nodiscard]] CompositeField field() const { return composite_field(cloud, area); }
};

Shape torus(Index n = 4000) {
  const Torus t;
  return {"torus", t.cloud(n), t.area(), [t](const Point<3>& p) { return t.depth(p); }};
}

Shape sphere(Index n = 2000) {
  return {"sphere", sphere_cloud(n), 4 * pi, [](const Point<3>& p) { return 1 - p.norm(); }};
}

Shape two_spheres() {
  // 0.4 apart, 5 spacings of the samples.
  const Point<3> a(-1.2, 0.1, 0), b(1.2, 0, 0.2);
  return {"two spheres", joined(sphere_cloud(2000, 1, 1, a), sphere_cloud(2000, 2, 1, b)), 8 * pi,
          [=](const Point<3>& p) { return std::max(1 - (p - a).norm(), 1 - (p - b).norm()); }};
}

// Points everywhere in and around the shape, and as many within a few spacings of it.
Points<3> probes(const Shape& shape, Index n, unsigned seed) {
  const Box<3> box = bounding_box<3>(shape.cloud.points);
  Points<3> points(3, 2 * n);
  points.leftCols(n) = random_points(n, box.inflated(0.5 * box.diagonal()), seed);
  std::mt19937_64 random(seed);
  for (Index i = n; i < 2 * n; ++i) {
    const auto sample = static_cast<Index>(random() % static_cast<std::uint64_t>(shape.cloud.size()));
    points.col(i) = shape.cloud.points.col(sample);
  }
  std::normal_distribution<double> normal(0, 1.5 * shape.spacing());
  points.rightCols(n) += Points<3>::NullaryExpr(3, n, [&] { return normal(random); });
  return points;
}

double quantile(std::vector<double> values, double q) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Errors of central differences with step h of values against gradients and of gradients against Hessians.
struct DifferenceErrors {
  std::vector<double> gradient, hessian;
};
DifferenceErrors difference_errors(const CompositeField& field, const Points<3>& x, double h) {
  const Jet<3> jet = field.evaluate(x, Derivatives::hessian);
  DifferenceErrors errors;
  for (int a = 0; a < 3; ++a) {
    const Point<3> step = h * Point<3>::Unit(a);
    const Jet<3> after = field.evaluate(x.colwise() + step, Derivatives::gradient);
    const Jet<3> before = field.evaluate(x.colwise() - step, Derivatives::gradient);
    for (Index i = 0; i < x.cols(); ++i) {
      errors.gradient.push_back(std::abs((after.value[i] - before.value[i]) / (2 * h) - jet.gradient(a, i)));
      const Point<3> second = (after.gradient.col(i) - before.gradient.col(i)) / (2 * h);
      errors.hessian.push_back((second - jet.hessian_matrix(i).col(a)).norm());
    }
  }
  return errors;
}

class CompositeFieldOf : public testing::TestWithParam<int> {
 protected:
  static Shape shape() {
    if (GetParam() == 0) return sphere();
    return GetParam() == 1 ? torus() : two_spheres();
  }
};
std::string shape_name(const testing::TestParamInfo<int>& info) {
  if (info.param == 0) return "Sphere";
  return info.param == 1 ? "Torus" : "TwoSpheres";
}
INSTANTIATE_TEST_SUITE_P(Shapes, CompositeFieldOf, testing::Values(0, 1, 2), shape_name);

TEST_P(CompositeFieldOf, HasTheRightSignEverywhere) {
  const Shape s = shape();
  const CompositeField field = s.field();
  const Points<3> x = probes(s, 20000, 1);
  const Jet<3> f = field.evaluate(x);
  Index inside = 0;
  for (Index i = 0; i < x.cols(); ++i) {
    const double depth = s.depth(x.col(i));
    inside += depth > 0 ? 1 : 0;
    if (std::abs(depth) < 0.05 * s.spacing()) continue;  // the error of the fit is below 2 % of the spacing
    EXPECT_GT(f.value[i] * depth, 0) << x.col(i).transpose() << " depth " << depth / s.spacing() << " spacings";
  }
  EXPECT_GT(inside, 1000);
}

TEST_P(CompositeFieldOf, IsTheDistanceNearTheSurface) {
  const Shape s = shape();
  const CompositeField field = s.field();
  Points<3> x = s.cloud.points;
  const Jet<3> on = field.evaluate(x, Derivatives::gradient);
  std::vector<double> value, slope, turn;
  for (Index i = 0; i < x.cols(); ++i) {
    value.push_back(std::abs(on.value[i]) / s.spacing());
    slope.push_back(std::abs(on.gradient.col(i).norm() - 1));
    turn.push_back((on.gradient.col(i) + s.cloud.normals.col(i)).norm());
  }
  EXPECT_LT(quantile(value, 1), 0.02);
  EXPECT_LT(quantile(slope, 1), 0.05);
  EXPECT_LT(quantile(turn, 1), 0.05);
  for (const double depth : {-0.5, 0.5}) {
    const Jet<3> off = field.evaluate(x - depth * s.spacing() * s.cloud.normals);
    std::vector<double> error;
    for (Index i = 0; i < x.cols(); ++i) error.push_back(std::abs(off.value[i] / s.spacing() - depth));
    EXPECT_LT(quantile(error, 0.95), 0.1 * std::abs(depth));
  }
}

TEST_P(CompositeFieldOf, IsBoundedByItsFarValueWhereThereAreNoData) {
  const Shape s = shape();
  const CompositeField field = s.field();
  const double far = field.data().far_value * field.data().scale;
  const Points<3> directions = sphere_cloud(50).points;
  for (const double radius : {1e1, 1e3, 1e6, 1e12}) {
    const Jet<3> f = field.evaluate(radius * directions, Derivatives::hessian);
    for (Index i = 0; i < directions.cols(); ++i) EXPECT_NEAR(f.value[i], -far, (winding_error + 2 / radius) * far);
    EXPECT_TRUE(f.gradient.allFinite() && f.hessian.allFinite());
    EXPECT_LT(f.gradient.colwise().norm().maxCoeff(), far / radius);
  }
}

TEST_P(CompositeFieldOf, HasDerivativesThatAgreeWithDifferencesOfSecondOrder) {
  const Shape s = shape();
  const CompositeField field = s.field();
  const double h = s.spacing();
  const Points<3> x = probes(s, 3000, 2);
  // Half of the points are within a few spacings of the surface, where patches of all levels and the winding number are
  // blended. The worst points straddle faces of the winding number's cubes.
  const DifferenceErrors coarse = difference_errors(field, x, 0.03 * h), fine = difference_errors(field, x, 0.01 * h);
  EXPECT_LT(quantile(fine.gradient, 0.5), 1e-6);
  EXPECT_LT(quantile(fine.gradient, 0.95), 1e-3);
  EXPECT_LT(quantile(fine.hessian, 0.5), 1e-6 / h);
  EXPECT_LT(quantile(fine.hessian, 0.95), 5e-2 / h);
  // Below these errors the order is hidden by those faces.
  constexpr double floor = 2e-6;
  for (const double q : {0.6, 0.7, 0.8}) {
    if (quantile(coarse.gradient, q) > floor) {
      EXPECT_GT(std::log(quantile(coarse.gradient, q) / quantile(fine.gradient, q)) / std::log(3.0), 1.4) << q;
    }
    if (quantile(coarse.hessian, q) > 30 * floor / h) {
      EXPECT_GT(std::log(quantile(coarse.hessian, q) / quantile(fine.hessian, q)) / std::log(3.0), 1.4) << q;
    }
  }
}

TEST_P(CompositeFieldOf, IsContinuousAlongLinesThroughEverything) {
  const Shape s = shape();
  const CompositeField field = s.field();
  const double jump = winding_error * field.data().far_value * field.data().scale;
  const Box<3> box = field.bounds().inflated(0.3);
  const Points<3> ends = random_points(40, box, 3);
  constexpr Index steps = 20000;
  for (Index line = 0; line < ends.cols(); line += 2) {
    const Point<3> step = (ends.col(line + 1) - ends.col(line)) / static_cast<double>(steps);
    Points<3> x(3, steps);
    for (Index i = 0; i < steps; ++i) x.col(i) = ends.col(line) + static_cast<double>(i) * step;
    const Jet<3> f = field.evaluate(x, Derivatives::gradient);
    for (Index i = 1; i < steps; ++i) {
      // The trapezoidal rule; steps are a thousandth of a spacing.
      const double predicted = 0.5 * (f.gradient.col(i - 1) + f.gradient.col(i)).dot(step);
      ASSERT_NEAR(f.value[i] - f.value[i - 1], predicted, jump);
    }
  }
}

TEST_P(CompositeFieldOf, MovesAndScalesWithTheCloud) {
  const Shape s = shape();
  const CompositeField field = s.field();
  const Points<3> x = probes(s, 2000, 4);
  const Eigen::VectorXd f = field.evaluate(x).value;
  Similarity map;
  map.scale = 0x1p-10;
  EXPECT_EQ(composite_field(map(s.cloud), map.scale * map.scale * s.area).evaluate(map(x)).value, map.scale * f);

  map.scale = 1e-3;
  map.shift << 1, -2, 3;
  const CompositeField image = composite_field(map(s.cloud), map.scale * map.scale * s.area);
  EXPECT_NEAR(image.feature_size(), map.scale * field.feature_size(), 1e-6 * map.scale);
  // Rounding may move the cubes of the winding number.
  const double far = field.data().far_value * field.data().scale;
  EXPECT_LT((image.evaluate(map(x)).value / map.scale - f).cwiseAbs().maxCoeff(), winding_error * far);
  // On the surface the patches alone decide. Coordinates of order 3 hold the shape to 4e-13, times the conditioning.
  const Points<3>& on = s.cloud.points;
  const Eigen::VectorXd difference = image.evaluate(map(on)).value / map.scale - field.evaluate(on).value;
  EXPECT_LT(quantile({difference.begin(), difference.end()}, 0.99), 1e-6);
}

TEST_P(CompositeFieldOf, TurnsWithTheCloud) {
  const Shape s = shape();
  const CompositeField field = s.field();
  const Similarity map = rotation(1);
  const CompositeField image = composite_field(map(s.cloud), s.area);
  // The box of the turned cloud has another diagonal, and other samples make up its coarse levels; near the data the
  // finest patches alone decide.
  const Points<3> x = s.cloud.points + 0.3 * s.spacing() * s.cloud.normals;
  const Jet<3> f = field.evaluate(x), g = image.evaluate(map(x));
  std::vector<double> error;
  for (Index i = 0; i < x.cols(); ++i) error.push_back(std::abs(g.value[i] - f.value[i]) / s.spacing());
  EXPECT_LT(quantile(error, 0.95), 1e-6);
  EXPECT_LT(quantile(error, 1), 0.5);
}

TEST_P(CompositeFieldOf, GivesValuesThatDoNotDependOnThreadsOrNeighbours) {
  const Shape s = shape();
  const CompositeField field = s.field();
  const Points<3> x = probes(s, 2000, 5);
  const Jet<3> expected = field.evaluate(x, Derivatives::hessian);
  for (const int threads : {1, 2, 5}) {
    set_thread_count(threads);
    const Jet<3> f = s.field().evaluate(x, Derivatives::hessian);
    EXPECT_EQ(f.value, expected.value);
    EXPECT_EQ(f.gradient, expected.gradient);
    EXPECT_EQ(f.hessian, expected.hessian);
  }
  set_thread_count(0);
  const Jet<3> reversed = field.evaluate(x.rowwise().reverse(), Derivatives::hessian);
  EXPECT_EQ(reversed.value.reverse(), expected.value);
  EXPECT_EQ(reversed.hessian.rowwise().reverse(), expected.hessian);
  const Eigen::VectorXd values = field.evaluate(x).value;
  for (Index i = 0; i < x.cols(); ++i) {
    EXPECT_NEAR(values[i], expected.value[i], 1e-10);
    EXPECT_EQ(field(x.col(i)), values[i]);
  }
}

TEST_P(CompositeFieldOf, HasSeedsOnTheSurface) {
  const Shape s = shape();
  const CompositeField field = s.field();
  const Points<3> seeds = field.seeds();
  EXPECT_EQ(seeds.cols(), field.data().levels.front().size());
  for (Index i = 0; i < seeds.cols(); ++i) EXPECT_LT(std::abs(s.depth(seeds.col(i))), s.spacing());
  for (Index i = 0; i < s.cloud.size(); i += 10)
    EXPECT_LT((seeds.colwise() - s.cloud.points.col(i)).colwise().norm().minCoeff(), 4 * s.spacing());
  EXPECT_NEAR(field.feature_size(), s.spacing(), 0.1 * s.spacing());
  EXPECT_EQ(field.bounds().lo, bounding_box<3>(s.cloud.points).lo);
}

TEST(CompositeField, ClosesAHoleSmoothly) {
  // No samples within 25 degrees of the pole: the hole is 0.85 wide, more than ten spacings.
  const PointCloud all = sphere_cloud(2000);
  std::vector<Index> kept;
  for (Index i = 0; i < all.size(); ++i)
    if (all.points(2, i) < std::cos(25 * pi / 180)) kept.push_back(i);
  const PointCloud cloud{all.points(Eigen::all, kept), all.normals(Eigen::all, kept), {}};
  const CompositeField field = composite_field(cloud, 4 * pi * static_cast<double>(kept.size()) / 2000);
  // Flat across the rim would be at z = 0.906; the sphere is at 1.
  EXPECT_GT(field(Point<3>(0, 0, 0.93)), 0);
  EXPECT_LT(field(Point<3>(0, 0, 1.07)), 0);
  Index crossings = 0;
  for (double z = -3; z < 3; z += 0.001) crossings += field(Point<3>(0, 0, z)) * field(Point<3>(0, 0, z + 0.001)) < 0;
  EXPECT_EQ(crossings, 2);
}

TEST(CompositeField, NeedsNoCoarseLevel) {
  const Shape s = sphere(200);
  const CompositeField field = s.field();
  EXPECT_EQ(field.data().levels.size(), 1);
  EXPECT_GT(field(Point<3>::Zero()), 0);
  EXPECT_LT(field(Point<3>(0, 0, 1.5)), 0);
}

}  // namespace
}  // namespace csrbf::composite_field_test
