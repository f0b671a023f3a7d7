#include "csrbf/surface/winding/winding_number.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/surface/winding/winding_cubes.hpp"
#include "surface/oriented_shapes.hpp"

#include <gtest/gtest.h>

namespace csrbf::winding_number_test {
namespace {

// Documented error of u: expansions and polynomials each err by half of it.
constexpr double tolerance = 2e-3, typical = 4e-4;
// Smoothing length in spacings.
constexpr double smoothing = 0.7;

WindingNumber::Data samples(const Shape& shape) {
  const Index n = shape.size();
  return {shape.points, shape.normals, Eigen::VectorXd::Constant(n, shape.area / static_cast<double>(n)),
          Eigen::VectorXd::Constant(n, smoothing * shape.spacing())};
}

// Closed form for a sphere: w = -R^2 S'(R), S(R) the mean over the sphere of 1 / sqrt(|p - x|^2 + eps^2).
double smoothed_sphere(double radius, double d, double eps) {
  const double a = std::hypot(radius + d, eps), b = std::hypot(radius - d, eps);
  const double w = (a - b) / (2 * d) - radius * ((radius + d) / a - (radius - d) / b) / (2 * d);
  return 2 * w - 1;
}

// Sum over all samples, in double precision.
Jet<3> direct_sum(const WindingNumber::Data& data, const Points<3>& x) {
  Jet<3> jet(x.cols(), Derivatives::hessian);
  for (Index i = 0; i < x.cols(); ++i) {
    double u = 0;
    Point<3> gradient = Point<3>::Zero();
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    for (Index k = 0; k < data.points.cols(); ++k) {
      const Point<3> r = data.points.col(k) - x.col(i), m = data.areas[k] * data.normals.col(k);
      const double D = r.squaredNorm() + data.eps[k] * data.eps[k], D3 = 1 / (D * std::sqrt(D)), mr = m.dot(r);
      u += mr * D3;
      gradient += 3 * mr * D3 / D * r - D3 * m;
      const Eigen::Matrix3d mixed = m * r.transpose();
      hessian +=
          D3 / D *
          (15 * mr / D * r * r.transpose() - 3 * (mixed + mixed.transpose()) - 3 * mr * Eigen::Matrix3d::Identity());
    }
    const double unit = 1 / (2 * std::numbers::pi);
    jet.value[i] = unit * u - 1;
    jet.gradient.col(i) = unit * gradient;
    for (int a = 0, entry = 0; a < 3; ++a)
      for (int b = a; b < 3; ++b, ++entry) jet.hessian(entry, i) = unit * hessian(a, b);
  }
  return jet;
}

// Points near the surface, in the volume, and far outside.
Points<3> queries(const Shape& shape, Index count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Points<3> x(3, count);
  for (Index i = 0; i < count; ++i) {
    const Point<3> noise(uniform(random), uniform(random), uniform(random));
    const Index k = (i * 7919) % shape.size();
    if (i % 3 == 0) x.col(i) = shape.points.col(k) + 3 * shape.spacing() * noise;
    if (i % 3 == 1) x.col(i) = 1.5 * noise;
    if (i % 3 == 2) x.col(i) = 20 * noise;
  }
  return x;
}

TEST(WindingNumber, OfNoSamplesIsOutsideEverywhere) {
  const Jet<3> jet = WindingNumber().evaluate(Points<3>::Random(3, 5), Derivatives::hessian);
  EXPECT_EQ(jet.value, Eigen::VectorXd::Constant(5, -1));
  EXPECT_EQ(jet.gradient, Points<3>::Zero(3, 5));
  EXPECT_TRUE(WindingNumber().bounds().empty());
  EXPECT_EQ(WindingNumber().seeds().cols(), 0);
}

TEST(WindingNumber, OfOneSampleIsItsKernel) {
  const WindingNumber u(Point<3>(1, 2, 3), Point<3>(0, 0, 1), Eigen::VectorXd::Constant(1, 0.5),
                        Eigen::VectorXd::Constant(1, 0.1));
  const double expected = 2 * 0.5 * 0.3 / (4 * std::numbers::pi * std::pow(0.3 * 0.3 + 0.1 * 0.1, 1.5)) - 1;
  EXPECT_NEAR(u({1, 2, 2.7}), expected, 1e-6 * std::abs(expected));  // single precision
  EXPECT_EQ(u({1, 2, 3}), -1);
}

TEST(WindingNumber, OfASphereIsTheClosedForm) {
  const Shape sphere = even_sphere(30000, {3, -2, 5}, 2);
  // Even samples in place of the surface err by exp(-2 pi eps / spacing), here 1e-4.
  const double eps = 1.5 * sphere.spacing();
  WindingNumber::Data data = samples(sphere);
  data.eps.setConstant(eps);
  const WindingNumber u(data);
  for (const double d :
       {0.01, 0.5, 1.0, 1.5, 1.9, 2 - 2 * eps, 2 - eps, 2.0, 2 + eps, 2 + 3 * eps, 2.5, 4.0, 10.0, 30.0})
    for (const Point<3>& direction : {Point<3>(1, 0, 0), Point<3>(1, -2, 2), Point<3>(-3, -4, 12)})
      EXPECT_NEAR(u(Point<3>(3, -2, 5) + d * direction.normalized()), smoothed_sphere(2, d, eps), tolerance) << d;
}

TEST(WindingNumber, BelowASmoothSurfaceIsDepthOverSmoothedDepth) {
  const Shape sphere = even_sphere(30000);
  const WindingNumber u(samples(sphere));
  const double eps = smoothing * sphere.spacing();
  for (const double t : {-4 * eps, -eps, -0.3 * eps, 0.0, 0.5 * eps, 2 * eps})
    EXPECT_NEAR(u((1 - t) * Point<3>(2, 3, 6) / 7), t / std::hypot(t, eps), eps) << t;  // curvature 1
}

TEST(WindingNumber, AgreesWithTheSumOverAllSamples) {
  const Shape torus = random_torus(20000, 1);
  const WindingNumber::Data data = samples(torus);
  const WindingNumber u(data);
  const Points<3> x = queries(torus, 600, 2);
  const Jet<3> jet = u.evaluate(x, Derivatives::hessian), direct = direct_sum(data, x);
  const double s = torus.spacing();
  const Eigen::VectorXd error = (jet.value - direct.value).cwiseAbs();
  EXPECT_LT(error.maxCoeff(), tolerance);
  EXPECT_LT(error.norm() / std::sqrt(static_cast<double>(x.cols())), typical);
  // Differentiating the polynomial of a cube of half side h > 1.2 spacings multiplies its error by up to 9 / h.
  EXPECT_LT(s * (jet.gradient - direct.gradient).colwise().norm().maxCoeff(), 4 * tolerance);
  EXPECT_LT(s * s * (jet.hessian - direct.hessian).colwise().norm().maxCoeff(), 20 * tolerance);
}

TEST(WindingNumber, DerivativesAreThoseOfTheValue) {
  // Few samples: one cube without polynomial, so that nothing jumps.
  const Shape sphere = even_sphere(200);
  const WindingNumber u(samples(sphere));
  const Points<3> x = 1.1 * even_sphere(50).points + 0.3 * even_sphere(50).normals.rowwise().reverse();
  const double h = 0.02 * sphere.spacing();
  constexpr double finite_difference = 2e-3;  // h^2 / 6 of third derivatives, and single precision / h
  const Jet<3> jet = u.evaluate(x, Derivatives::hessian);
  for (int axis = 0; axis < 3; ++axis) {
    const Points<3> step = (h * Point<3>::Unit(axis)).replicate(1, x.cols());
    const Jet<3> above = u.evaluate(x + step, Derivatives::gradient),
                 below = u.evaluate(x - step, Derivatives::gradient);
    for (Index i = 0; i < x.cols(); ++i) {
      const double scale = 1 / sphere.spacing();
      EXPECT_NEAR(jet.gradient(axis, i), (above.value[i] - below.value[i]) / (2 * h), finite_difference * scale);
      const Point<3> column = (above.gradient.col(i) - below.gradient.col(i)) / (2 * h);
      EXPECT_LT((jet.hessian_matrix(i).col(axis) - column).norm(), 4 * finite_difference * scale * scale);
    }
  }
}

TEST(WindingNumber, OutsideItsCubesTheExpansionHasTheSameDerivatives) {
  const Shape torus = random_torus(2000, 3);
  const WindingNumber::Data data = samples(torus);
  const Points<3> x = 30 * even_sphere(20).points;
  const Jet<3> jet = WindingNumber(data).evaluate(x, Derivatives::hessian), direct = direct_sum(data, x);
  EXPECT_LT((jet.value - direct.value).cwiseAbs().maxCoeff(), 1e-5);  // (radius / 30)^2 of a dipole field below 1e-3
  EXPECT_LT((jet.gradient - direct.gradient).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((jet.hessian - direct.hessian).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(WindingNumber, DoesNotDependOnTheBatchTheThreadsOrTheHistory) {
  const Shape torus = random_torus(20000, 4);
  const WindingNumber u(samples(torus));
  const Points<3> x = queries(torus, 2000, 5);
  set_thread_count(1);
  const Jet<3> jet = u.evaluate(x, Derivatives::hessian);
  for (const int threads : {2, 5}) {
    set_thread_count(threads);
    const WindingNumber fresh(samples(torus));
    const Jet<3> again = fresh.evaluate(x.rowwise().reverse().eval(), Derivatives::hessian);
    EXPECT_EQ(again.value.reverse(), jet.value);
    EXPECT_EQ(again.gradient.rowwise().reverse(), jet.gradient);
    EXPECT_EQ(again.hessian.rowwise().reverse(), jet.hessian);
  }
  set_thread_count(0);
  for (Index i = 0; i < 60; ++i) EXPECT_NEAR(u(x.col(i)), jet.value[i], 1e-6);  // other loops, single precision
}

TEST(WindingNumber, IsTheSameWhenBuiltFromItsData) {
  const Shape torus = random_torus(5000, 6);
  const WindingNumber u(samples(torus)), again(u.data());
  const Points<3> x = queries(torus, 300, 7);
  EXPECT_EQ(again.evaluate(x).value, u.evaluate(x).value);
  EXPECT_EQ(again.data().points, u.data().points);
  EXPECT_EQ(again.data().normals, u.data().normals);
  EXPECT_EQ(u.seeds().cols(), torus.size());
  EXPECT_EQ(u.seeds(), u.data().points);
  EXPECT_EQ(u.bounds().lo, bounding_box<3>(torus.points).lo);
}

TEST(WindingNumber, KeepsTheCubesThatWereMade) {
  const Shape shape = random_torus(20000, 4);
  const WindingNumber field(samples(shape));
  (void)field.evaluate(queries(shape, 500, 1));
  const winding::MadeCubes made = field.made_cubes();
  ASSERT_GT(made.children.size(), 100U);
  const WindingNumber again(field.tree(), made);
  EXPECT_EQ(again.made_cubes().far, made.far);
  EXPECT_EQ(again.made_cubes().near, made.near);
  const Points<3> x = queries(shape, 600, 2);
  const Jet<3> expected = field.evaluate(x, Derivatives::hessian), found = again.evaluate(x, Derivatives::hessian);
  EXPECT_EQ(found.value, expected.value);
  EXPECT_EQ(found.gradient, expected.gradient);
  EXPECT_EQ(found.hessian, expected.hessian);
  EXPECT_EQ(field.made_cubes().near, again.made_cubes().near);

  for (int damage = 0; damage < 4; ++damage) {
    winding::MadeCubes bad = made;
    if (damage == 0) bad.far.resize(bad.far.size() / 2);
    if (damage == 1) bad.near.back() = 1 << 30;
    if (damage == 2) bad.children.back() = 255;
    if (damage == 3) bad.near.push_back(0);
    EXPECT_THROW(WindingNumber(field.tree(), bad), InvalidInput) << damage;
  }
}

TEST(WindingNumber, IsInvariantUnderSimilarities) {
  const Shape torus = random_torus(5000, 8);
  const WindingNumber::Data data = samples(torus);
  const WindingNumber u(data);
  const Points<3> x = queries(torus, 300, 9);
  const Jet<3> jet = u.evaluate(x, Derivatives::gradient);
  for (const double scale : {1e-30, 1.0, 1e30}) {
    const Eigen::Matrix3d rotation = some_rotation();
    const Point<3> shift = scale * Point<3>(5, -3, 2);
    const auto move = [&](const Points<3>& p) { return Points<3>((scale * rotation * p).colwise() + shift); };
    const WindingNumber moved(move(data.points), rotation * data.normals, scale * scale * data.areas, scale * data.eps);
    const Jet<3> moved_jet = moved.evaluate(move(x), Derivatives::gradient);
    EXPECT_LT((moved_jet.value - jet.value).cwiseAbs().maxCoeff(), 2 * tolerance);
    const Points<3> gradient = scale * rotation.transpose() * moved_jet.gradient;
    EXPECT_LT(torus.spacing() * (gradient - jet.gradient).colwise().norm().maxCoeff(), 8 * tolerance);
  }
}

TEST(WindingNumber, FarAwayFallsToMinusOne) {
  const WindingNumber u(samples(random_torus(2000, 10)));
  double before = 1;
  for (double distance = 5; distance < 1e6; distance *= 10) {
    const double now = std::abs(u({distance, distance, 0.3 * distance}) + 1);
    EXPECT_LT(now, before);
    before = now;
  }
  EXPECT_NEAR(u({1e300, 0, 0}), -1, 1e-12);
  EXPECT_NEAR(u({0, -std::numeric_limits<double>::infinity(), 0}), -1, 1e-12);
  EXPECT_TRUE(std::isnan(u({0, std::numeric_limits<double>::quiet_NaN(), 0})));
}

TEST(WindingNumber, TakesCoincidingSamplesAndVeryUnevenOnes) {
  // A unit sphere, one of 1e-6 of its size, and 3000 samples in one place that cancel.
  const Shape unit = even_sphere(3000), tiny = even_sphere(3000, {5, 0, 0}, 1e-6);
  Shape heap = even_sphere(3000);
  heap.points.colwise() = Point<3>(2, 0, 0);
  WindingNumber::Data data = samples(join(join(unit, tiny), heap));
  for (Index i = 0; i < 9000; ++i) {
    const Shape& part = i >= 3000 && i < 6000 ? tiny : unit;
    data.areas[i] = part.area / 3000;
    data.eps[i] = smoothing * part.spacing();
  }
  const WindingNumber u(data);
  const double eps = smoothing * unit.spacing(), inside = smoothed_sphere(1, 1e-3, eps);
  EXPECT_NEAR(u({0, 0, 0}), inside, tolerance);
  EXPECT_NEAR(u({5, 0, 0}), inside, tolerance);
  EXPECT_NEAR(u({5 + 3e-6, 0, 0}), smoothed_sphere(1, 3, eps), tolerance);
  EXPECT_NEAR(u({2, 0, 0}), smoothed_sphere(1, 2, eps), tolerance);
}

template <class Change>
std::string failure(Change change) {
  WindingNumber::Data data = samples(even_sphere(10));
  change(data);
  return invalid_input_message([&] { const WindingNumber u(data); });
}

TEST(WindingNumber, RejectsSamplesThatMakeNoSense) {
  using Data = WindingNumber::Data;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(failure([](Data& d) { d.normals.resize(3, 9); }),
            "WindingNumber: normals.cols() = 9: must be the number of points");
  EXPECT_EQ(failure([](Data& d) { d.areas.resize(9); }),
            "WindingNumber: areas.size() = 9: must be the number of points");
  EXPECT_EQ(failure([](Data& d) { d.eps.resize(9); }), "WindingNumber: eps.size() = 9: must be the number of points");
  EXPECT_EQ(failure([&](Data& d) { d.points(1, 3) = nan; }),
            "WindingNumber: points = NaN or infinity: must be finite; remove such points");
  EXPECT_EQ(failure([&](Data& d) { d.normals(1, 3) = nan; }),
            "WindingNumber: normals = NaN or infinity: must be finite; set unknown normals to zero");
  EXPECT_EQ(failure([](Data& d) { d.areas[2] = -1; }),
            "WindingNumber: areas.minCoeff() = -1: areas must be finite and not negative");
  EXPECT_EQ(failure([](Data& d) { d.eps[2] = 0; }),
            "WindingNumber: eps.minCoeff() = 0: smoothing lengths must be finite and positive");
}

}  // namespace
}  // namespace csrbf::winding_number_test
