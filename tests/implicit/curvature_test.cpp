#include "csrbf/implicit/curvature.hpp"

#include "core/error_testing.hpp"
#include "implicit/analytic_fields.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace csrbf::curvature_test {
namespace {

constexpr double rounding = 1e-12;  // a dozen operations on numbers of order one

constexpr double major = 2, minor = 0.5;

Point<3> torus_point(double around, double angle) {
  const double rho = major + minor * std::cos(angle);
  return {rho * std::cos(around), rho * std::sin(around), minor * std::sin(angle)};
}

Points<3> ellipsoid_points(const Point<3>& axes, Index n, unsigned seed) {
  return axes.asDiagonal() * random_directions(n, seed);
}

PrincipalCurvatures at(const Field<3>& field, const Point<3>& p) {
  const Jet<3> jet = field.evaluate(p, Derivatives::hessian);
  return principal_curvatures(jet.gradient.col(0), jet.hessian_matrix(0));
}

TEST(Curvature, OfASphereIsOneOverItsRadiusInEveryDirection) {
  const Points<3> x = 2.5 * random_directions(200, 1);
  for (const AnalyticField& field : {ball(2.5), quadratic_ball(2.5)}) {
    const Curvatures found = curvature(field, x);
    EXPECT_LE((found.k1.array() - 0.4).abs().maxCoeff(), rounding);
    EXPECT_LE((found.k2.array() - 0.4).abs().maxCoeff(), rounding);
    EXPECT_LE((found.mean().array() - 0.4).abs().maxCoeff(), rounding);
    EXPECT_LE((found.gaussian().array() - 0.16).abs().maxCoeff(), rounding);
    EXPECT_LE((found.normals - x / 2.5).cwiseAbs().maxCoeff(), rounding);
    EXPECT_EQ(found.singular(), 0);
  }
}

TEST(Curvature, OfATorusIsThatOfItsTwoCircles) {
  const AnalyticField torus = distance_torus(major, minor);
  for (int i = 0; i < 40; ++i) {
    const double angle = 0.17 * i, c = std::cos(angle);
    const PrincipalCurvatures k = at(torus, torus_point(0.3 * i, angle));
    EXPECT_NEAR(k.k1, 1 / minor, rounding);
    EXPECT_NEAR(k.k2, c / (major + minor * c), rounding);
    // k1 is the curvature of the small circle, whose plane holds the axis.
    const Point<3> along(-std::sin(0.3 * i), std::cos(0.3 * i), 0);
    EXPECT_NEAR(std::abs(k.direction2.dot(along)), 1, rounding);
  }
}

TEST(Curvature, OfAnEllipsoidAtTheEndsOfItsAxes) {
  const Point<3> a(3, 2, 1);
  const AnalyticField field = ellipsoid(a);
  for (int i = 0; i < 3; ++i) {
    const double p = a[i], q = a[(i + 1) % 3], r = a[(i + 2) % 3];
    const PrincipalCurvatures k = at(field, p * Point<3>::Unit(i));
    EXPECT_NEAR(k.k1, std::max(p / (q * q), p / (r * r)), rounding);
    EXPECT_NEAR(k.k2, std::min(p / (q * q), p / (r * r)), rounding);
  }
}

TEST(Curvature, OfAnEllipsoidHasTheGaussianCurvatureOfItsSupportFunction) {
  const Point<3> a(3, 2, 1);
  const Points<3> x = ellipsoid_points(a, 500, 2);
  const Eigen::VectorXd found = curvature(ellipsoid(a), x).gaussian();
  for (Index i = 0; i < x.cols(); ++i) {
    const double h2 = 1 / (x.col(i).array() / a.array().square()).square().sum();
    EXPECT_NEAR(found[i] * a.prod() * a.prod(), h2 * h2, 40 * rounding);
  }
}

TEST(Curvature, OfAGrooveIsNegativeAcrossIt) {
  const AnalyticField groove([](const AnalyticField::Variables& x) { return x[0] * x[0] - x[2]; },
                             box_around(Point<3>::Zero(), Point<3>::Ones()));
  const PrincipalCurvatures k = at(groove, Point<3>(0, 0.3, 0));
  EXPECT_NEAR(k.k1, 0, rounding);
  EXPECT_NEAR(k.k2, -2, rounding);
  EXPECT_NEAR(std::abs(k.direction2[0]), 1, rounding);
}

TEST(Curvature, DirectionsAndNormalAreARightHandedFrame) {
  const Curvatures found = curvature(distance_torus(major, minor), 2.2 * random_directions(300, 3));
  for (Index i = 0; i < 300; ++i) {
    Eigen::Matrix3d frame;
    frame << found.direction1.col(i), found.direction2.col(i), found.normals.col(i);
    EXPECT_LE((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm(), rounding);
    EXPECT_GT(found.direction1.col(i).cross(found.direction2.col(i)).dot(found.normals.col(i)), 0);
    EXPECT_GE(found.k1[i], found.k2[i]);
  }
}

TEST(Curvature, DoesNotDependOnTheValuesOffTheSurface) {
  const Point<3> a(3, 2, 1);
  const Points<3> x = ellipsoid_points(a, 100, 4);
  const AnalyticField plain = ellipsoid(a);
  // (7 + x) f is zero on the same surface.
  const AnalyticField scaled(
      [=](const AnalyticField::Variables& p) {
        Taylor<3> f(1);
        for (int k = 0; k < 3; ++k) f = f - (1 / (a[k] * a[k])) * (p[k] * p[k]);
        return (7.0 + p[0]) * f;
      },
      plain.bounds());
  const Curvatures one = curvature(plain, x), other = curvature(scaled, x);
  EXPECT_LE((one.k1 - other.k1).cwiseAbs().maxCoeff(), 10 * rounding);
  EXPECT_LE((one.k2 - other.k2).cwiseAbs().maxCoeff(), 10 * rounding);
}

TEST(Curvature, IsUndefinedWhereTheGradientVanishes) {
  Points<3> x(3, 2);
  x << 0, 1, 0, 0, 0, 0;
  const Curvatures found = curvature(quadratic_ball(1), x);
  EXPECT_EQ(found.singular(), 1);
  EXPECT_TRUE(std::isnan(found.k1[0]));
  EXPECT_TRUE(found.normals.col(0).array().isNaN().all());
  EXPECT_NEAR(found.k1[1], 1, rounding);
}

TEST(Curvature, StopsWhenToldTo) {
  EXPECT_THROW(curvature(ball(1), random_directions(3, 5), [](std::string_view, double) { return false; }), Cancelled);
}

// The slope of the curvature on the section of an ellipsoid by a plane of symmetry, which is a line of curvature: the
// ellipse (p cos t, q sin t) has curvature p q / w^3, w^2 = p^2 sin^2 + q^2 cos^2, and ds = w dt.
double slope_on_ellipse(double p, double q, double t) {
  const double w2 = p * p * std::sin(t) * std::sin(t) + q * q * std::cos(t) * std::cos(t);
  return -3 * p * q * (p * p - q * q) * std::sin(t) * std::cos(t) / (w2 * w2 * w2);
}

TEST(CurvatureSlopes, OfAnEllipsoidConvergeAsTheSquareOfTheStep) {
  // Has odd derivatives of every order along every line.
  const AnalyticField field(
      [](const AnalyticField::Variables& x) {
        return (7.0 + x[0]) * (1.0 / ((1.0 / 9) * (x[0] * x[0]) + 0.25 * (x[1] * x[1]) + x[2] * x[2]) - 1.0);
      },
      box_around(Point<3>::Zero(), Point<3>(3, 2, 1)));
  const double t = 0.6;
  const Point<3> p(3 * std::cos(t), 0, std::sin(t)), along(-3 * std::sin(t), 0, std::cos(t));
  std::vector<double> errors;
  for (double step = 0.1; step > 0.01; step /= 2)
    errors.push_back(
        std::abs(curvature_slopes(field, p, Point<3>(along.normalized()), step)[0] - slope_on_ellipse(3, 1, t)));
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_GE(std::log2(errors[i - 1] / errors[i]), 1.9);
}

TEST(CurvatureSlopes, ChangeTheirSignWithTheDirection) {
  const AnalyticField field = ellipsoid({3, 2, 1});
  const Points<3> x = ellipsoid_points({3, 2, 1}, 50, 6);
  const Curvatures found = curvature(field, x);
  const Eigen::VectorXd one = curvature_slopes(field, x, found.direction1, 0.01);
  const Eigen::VectorXd other = curvature_slopes(field, x, -found.direction1, 0.01);
  EXPECT_GT(one.cwiseAbs().minCoeff(), 0);
  EXPECT_LE((one + other).cwiseAbs().maxCoeff(), rounding);
}

TEST(CurvatureSlopes, NeedAStepAndADirectionForEachPoint) {
  const AnalyticField field = ball(1);
  const Point<3> x(1, 0, 0);
  EXPECT_NE(invalid_input_message([&] { curvature_slopes(field, x, x, 0); }).find("step = 0"), std::string::npos);
  EXPECT_NE(invalid_input_message([&] { curvature_slopes(field, x, Points<3>(3, 0), 1); }).find("directions = 0"),
            std::string::npos);
}

}  // namespace
}  // namespace csrbf::curvature_test
