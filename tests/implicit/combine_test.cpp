#include "csrbf/implicit/combine.hpp"

#include "core/error_testing.hpp"
#include "csrbf/implicit/combine/extend_distance.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "implicit/analytic_fields.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace csrbf::combine_test {
namespace {

constexpr double rounding = 1e-13;  // a dozen operations on numbers of order one

const std::vector<Blending> all_blendings = {Blending::sharp, Blending::r_function, Blending::super_elliptic,
                                             Blending::log_sum_exp};

Solid solid(AnalyticField field) {
  return std::make_shared<const AnalyticField>(std::move(field));
}

const Solid left = solid(ball(1, {-0.6, 0, 0}));
const Solid right = solid(ball(0.9, {0.7, 0.1, 0}));
const Solid above = solid(ball(0.7, {0, 0.2, 0.9}));
const Box<3> around = box_around(Point<3>::Zero(), Point<3>(2.2, 1.6, 2));

CombineOptions with(Blending blending, double radius = 0.05, double sharpness = 3) {
  CombineOptions options;
  options.blending = blending;
  options.radius = radius;
  options.sharpness = sharpness;
  return options;
}

Eigen::VectorXd values(const Solid& field, const Points<3>& x) {
  return field->evaluate(x).value;
}

Mesh mesh_of(const Solid& field, int resolution = 48) {
  return polygonize(*field, {.resolution = resolution});
}

double volume(const Mesh& mesh) {
  double sum = 0;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corner = [&](int k) { return Point<3>(mesh.vertices.col(mesh.triangles(k, t))); };
    sum += corner(0).dot(corner(1).cross(corner(2))) / 6;
  }
  return sum;
}

TEST(Combine, HasTheSignsOfTheSetOperations) {
  const Points<3> x = random_points_in(around, 3000, 1);
  const Eigen::VectorXd a = values(left, x), b = values(right, x), c = values(above, x);
  for (const Blending blending : {Blending::sharp, Blending::r_function}) {
    const CombineOptions options = with(blending);
    const std::vector<Solid> all = {left, right, above};
    const Eigen::VectorXd united = values(combine(Operation::unite, all, options), x);
    const Eigen::VectorXd common = values(combine(Operation::intersect, all, options), x);
    const Eigen::VectorXd rest = values(combine(Operation::subtract, all, options), x);
    const Eigen::VectorXd outside = values(combine(Operation::complement, {left}, options), x);
    for (Index i = 0; i < x.cols(); ++i) {
      EXPECT_EQ(united[i] > 0, a[i] > 0 || b[i] > 0 || c[i] > 0);
      EXPECT_EQ(common[i] > 0, a[i] > 0 && b[i] > 0 && c[i] > 0);
      EXPECT_EQ(rest[i] > 0, a[i] > 0 && !(b[i] > 0) && !(c[i] > 0));
      EXPECT_EQ(outside[i], -a[i]);
    }
  }
}

TEST(Combine, OperatorsAreTheSharpOperations) {
  const Points<3> x = random_points_in(around, 200, 2);
  const Eigen::VectorXd a = values(left, x), b = values(right, x);
  EXPECT_EQ(values(left | right, x), a.cwiseMax(b));
  EXPECT_EQ(values(left & right, x), a.cwiseMin(b));
  EXPECT_EQ(values(left - right, x), a.cwiseMin(-b));
  EXPECT_EQ(values(~left, x), -a);
  EXPECT_EQ(values((left | right) - above, x), a.cwiseMax(b).cwiseMin(-values(above, x)));
}

TEST(Combine, ObeysDeMorgan) {
  const Points<3> x = random_points_in(around, 500, 3);
  for (const Blending blending : all_blendings) {
    const CombineOptions options = with(blending, 0.1);
    const Solid common = combine(Operation::intersect, {left, right}, options);
    const Solid other = ~combine(Operation::unite, {~left, ~right}, options);
    EXPECT_EQ(values(common, x), values(other, x));
    const Solid rest = combine(Operation::subtract, {left, right}, options);
    EXPECT_EQ(values(rest, x), values(combine(Operation::intersect, {left, ~right}, options), x));
  }
}

TEST(Combine, BlendsTakeTheValuesOfTheirFormulas) {
  const Points<3> x = random_points_in(around, 500, 4);
  const Eigen::VectorXd f = values(left, x), g = values(right, x);
  Box<3> box = left->bounds();
  box.add(right->bounds());
  const double R = 0.2 * box.diagonal();
  const std::vector<Solid> both = {left, right};
  const Eigen::VectorXd r = values(combine(Operation::unite, both, with(Blending::r_function)), x);
  const Eigen::VectorXd linear = values(combine(Operation::unite, both, with(Blending::super_elliptic, 0.2, 1)), x);
  const Eigen::VectorXd elliptic = values(combine(Operation::unite, both, with(Blending::super_elliptic, 0.2, 2.5)), x);
  const Eigen::VectorXd lse = values(combine(Operation::unite, both, with(Blending::log_sum_exp, 0.2, 4)), x);
  for (Index i = 0; i < x.cols(); ++i) {
    EXPECT_NEAR(r[i], f[i] + g[i] + std::hypot(f[i], g[i]), rounding);
    EXPECT_NEAR(lse[i], R / 4 * std::log(std::exp(4 * f[i] / R) + std::exp(4 * g[i] / R)), 10 * rounding);
    const double u = std::max(0.0, 1 + f[i] / R), v = std::max(0.0, 1 + g[i] / R);
    if (u + v == 0) continue;
    EXPECT_NEAR(linear[i], R * (u + v - 1), rounding);
    EXPECT_NEAR(elliptic[i], R * (std::pow(std::pow(u, 2.5) + std::pow(v, 2.5), 0.4) - 1), 10 * rounding);
  }
}

TEST(Combine, BlendsStayAboveTheUnionWithinTheirBounds) {
  const Points<3> x = random_points_in(around, 2000, 5);
  const std::vector<Solid> all = {left, right, above};
  const Eigen::VectorXd most = values(left, x).cwiseMax(values(right, x)).cwiseMax(values(above, x));
  Box<3> box;
  for (const Solid& part : all) box.add(part->bounds());
  const double R = 0.1 * box.diagonal(), b = 3;
  const Eigen::VectorXd lse = values(combine(Operation::unite, all, with(Blending::log_sum_exp, 0.1, b)), x) - most;
  const Eigen::VectorXd elliptic =
      values(combine(Operation::unite, all, with(Blending::super_elliptic, 0.1, b)), x) - most;
  EXPECT_GE(lse.minCoeff(), -rounding);
  EXPECT_LE(lse.maxCoeff(), R / b * std::log(3));
  EXPECT_GE(elliptic.minCoeff(), -rounding);
  // (sum v^b)^(1/b) <= 3^(1/b) max v, and v <= 1 + most / R.
  EXPECT_LE((elliptic.array() - (std::cbrt(3.0) - 1) * (R + most.array().max(-R))).maxCoeff(), rounding);
}

TEST(Combine, SuperEllipticBlendsReachNoFurtherThanTheirRange) {
  const Points<3> x = random_points_in(around, 3000, 6);
  const Eigen::VectorXd f = values(left, x), g = values(right, x);
  Box<3> box = left->bounds();
  box.add(right->bounds());
  const double R = 0.05 * box.diagonal();
  const Eigen::VectorXd blended =
      values(combine(Operation::unite, {left, right}, with(Blending::super_elliptic, 0.05)), x);
  int beyond = 0;
  for (Index i = 0; i < x.cols(); ++i) {
    if (std::min(f[i], g[i]) > -R) continue;
    ++beyond;
    EXPECT_NEAR(blended[i], std::max(f[i], g[i]), rounding);
  }
  EXPECT_GT(beyond, 1000);
}

TEST(Combine, BlendsTendToTheSharpUnion) {
  const Points<3> x = random_points_in(around, 300, 7);
  const Eigen::VectorXd sharp = values(left | right, x);
  for (const Blending blending : {Blending::super_elliptic, Blending::log_sum_exp}) {
    const Eigen::VectorXd blend = values(combine(Operation::unite, {left, right}, with(blending, 0.05, 1e6)), x);
    EXPECT_LE((blend - sharp).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(Combine, HasTrueDerivatives) {
  constexpr double step = 1e-5;  // differences err by its square times third derivatives of about 1e3
  Points<3> x = random_points_in(around, 400, 8);
  // Away from the creases of the sharp union, the corner of the R-function, and the centres of the balls.
  const Eigen::VectorXd f = values(left, x), g = values(right, x), h = values(above, x);
  std::vector<Index> kept;
  for (Index i = 0; i < x.cols(); ++i) {
    const double close = std::min({std::abs(f[i] - g[i]), std::abs(f[i] - h[i]), std::abs(g[i] - h[i])});
    const double deep = std::max({f[i], g[i] + 0.1, h[i] + 0.3});
    if (close > 0.05 && deep < 0.8 && std::max(f[i], g[i]) > -0.4) kept.push_back(i);
  }
  ASSERT_GT(kept.size(), 50U);
  x = Points<3>(x(Eigen::all, kept));
  for (const Blending blending : all_blendings)
    for (const Operation operation : {Operation::unite, Operation::intersect, Operation::subtract}) {
      const Solid combined = combine(operation, {left, right, above}, with(blending, 0.15));
      const DerivativeErrors errors = derivative_errors(*combined, x, step);
      EXPECT_LE(errors.gradient, 1e-7) << name_of(blending) << " " << name_of(operation);
      EXPECT_LE(errors.hessian, 1e-6) << name_of(blending) << " " << name_of(operation);
    }
}

TEST(Combine, GivesTheSameValuesWithFewerDerivatives) {
  const Points<3> x = random_points_in(around, 700, 9);
  for (const Blending blending : all_blendings) {
    const Solid combined = combine(Operation::unite, {left, right, above}, with(blending, 0.1));
    const Jet<3> all = combined->evaluate(x, Derivatives::hessian);
    const Jet<3> some = combined->evaluate(x, Derivatives::gradient);
    EXPECT_LE((all.value - values(combined, x)).cwiseAbs().maxCoeff(), rounding);
    EXPECT_EQ(all.value, some.value);
    EXPECT_EQ(all.gradient, some.gradient);
  }
}

TEST(Combine, MeshesOfSharpOperationsHaveTheVolumesOfBalls) {
  // Two unit balls whose centres are 1 apart share a lens of 5 pi / 12.
  const Solid a = solid(ball(1, {-0.5, 0.01, 0.02})), b = solid(ball(1, {0.5, 0.01, 0.02}));
  const double one = 4 * pi / 3, lens = 5 * pi / 12;
  // Edges are cut off by about a cell.
  EXPECT_NEAR(volume(mesh_of(a | b)), 2 * one - lens, 0.02);
  EXPECT_NEAR(volume(mesh_of(a & b)), lens, 0.02);
  EXPECT_NEAR(volume(mesh_of(a - b)), one - lens, 0.02);
  EXPECT_NEAR(volume(mesh_of(~a)), -one, 0.02);
}

TEST(Combine, MeshesAreClosedAndHaveTheRightHoles) {
  const Solid drill = solid({[](const AnalyticField::Variables& x) { return 0.16 - x[0] * x[0] - x[1] * x[1]; },
                             box_around(Point<3>::Zero(), Point<3>(0.4, 0.4, 3))});
  const Solid block = solid(ball(1, {0.01, 0.02, 0.03}));
  for (const Blending blending : all_blendings) {
    const Topology drilled = topology(mesh_of(combine(Operation::subtract, {block, drill}, with(blending))));
    EXPECT_TRUE(drilled.watertight() && drilled.manifold()) << name_of(blending);
    EXPECT_EQ(drilled.euler, 0) << name_of(blending);
    const Topology three = topology(mesh_of(combine(Operation::unite, {left, right, above}, with(blending))));
    EXPECT_TRUE(three.watertight() && three.manifold()) << name_of(blending);
    EXPECT_EQ(three.euler, 2) << name_of(blending);
  }
}

TEST(Combine, BoundsHoldTheSurface) {
  for (const Blending blending : all_blendings) {
    const CombineOptions options = with(blending, 0.1);
    for (const Solid& combined :
         {combine(Operation::unite, {left, right}, options), combine(Operation::intersect, {left, right}, options),
          combine(Operation::subtract, {left, right}, options), combine(Operation::intersect, {~left, ~right}, options),
          combine(Operation::subtract, {~left, right}, options)}) {
      const Mesh mesh = polygonize(*combined, {.resolution = 20, .bounds = around.inflated(0.3), .normals = false});
      const Box<3> box = combined->bounds().inflated(1e-4);
      for (Index v = 0; v < mesh.vertices.cols(); ++v) EXPECT_TRUE(box.contains(mesh.vertices.col(v)));
    }
  }
  EXPECT_EQ((left - right)->bounds().lo, left->bounds().lo);
  EXPECT_EQ((left & right)->bounds().hi[0], left->bounds().hi[0]);
  EXPECT_EQ((left | right)->bounds().hi[0], right->bounds().hi[0]);
}

TEST(Combine, OfSolidsThatDoNotMeetHasNoSurface) {
  const Solid far = solid(ball(1, {9, 0, 0}));
  EXPECT_THROW(mesh_of(left & far), SolverFailure);
  EXPECT_EQ(topology(mesh_of(left | far)).components, 2);
}

TEST(Combine, KnowsSeedsAndDetailWhenItsSolidsDo) {
  const Solid fine = solid({[](const AnalyticField::Variables& x) { return x[0]; }, around, Point<3>(0, 0, 0), 0.01});
  const Solid coarse = solid({[](const AnalyticField::Variables& x) { return x[1]; }, around, Point<3>(1, 0, 0), 0.1});
  const Solid unknown = solid({[](const AnalyticField::Variables& x) { return x[2]; }, around});
  EXPECT_EQ((fine | coarse)->seeds().cols(), 2);
  EXPECT_EQ((fine | coarse)->feature_size(), 0.01);
  EXPECT_EQ((fine | unknown)->seeds().cols(), 0);
  EXPECT_EQ((fine | unknown)->feature_size(), 0.01);
}

TEST(Combine, GrowsWithTheSolids) {
  const Solid a = solid(ball(64, {-38.4, 0, 0})), b = solid(ball(57.6, {44.8, 6.4, 0}));
  const Points<3> x = random_points_in(around, 300, 10);
  for (const Blending blending : all_blendings) {
    const Eigen::VectorXd small = values(combine(Operation::unite, {left, right}, with(blending)), x);
    const Eigen::VectorXd large = values(combine(Operation::unite, {a, b}, with(blending)), 64 * x);
    EXPECT_LE((64 * small - large).cwiseAbs().maxCoeff(), 64 * 10 * rounding);
  }
}

TEST(Combine, ExtendsTheDistanceOfSolidsThatForgetIt) {
  const Solid a = solid(saturated_ball(1, {-1.2, 0, 0}, 0.02)), b = solid(saturated_ball(1, {1.2, 0, 0}, 0.02));
  const Solid blend = combine(Operation::unite, {a, b}, with(Blending::super_elliptic, 0.1));
  // The range is 0.1 * 5.3: further from the other ball each keeps its surface.
  for (const double angle : {2.0, 2.5, 3.0}) {
    const Point<3> p(-1.2 + std::cos(angle), std::sin(angle), 0);
    EXPECT_NEAR((*blend)(p), 0, rounding);
  }
  // The gap of 0.4 is bridged: R 2^(1/3) (1 - 0.2 / R) - R = 0.21 R with the distances, and the sphere's are blurred.
  const double R = 0.1 * Point<3>(4.4, 2, 2).norm();
  EXPECT_NEAR((*blend)(Point<3>::Zero()), std::cbrt(2.0) * (R - 0.2) - R, 0.02);
}

TEST(Combine, NamesItsOperationsAndBlendings) {
  for (const Blending blending : all_blendings) EXPECT_EQ(blending_named(name_of(blending)), blending);
  EXPECT_EQ(operation_named("difference"), Operation::subtract);
  EXPECT_EQ(operation_named("blend"), std::nullopt);
  EXPECT_EQ(blending_named(""), std::nullopt);
}

TEST(Combine, RefusesWhatItCannotCombine) {
  const auto message = [](Operation operation, const std::vector<Solid>& solids, const CombineOptions& options = {}) {
    return invalid_input_message([&] { combine(operation, solids, options); });
  };
  EXPECT_NE(message(Operation::unite, {left}).find("solids = 1: at least two"), std::string::npos);
  EXPECT_NE(message(Operation::complement, {left, right}).find("solids = 2: the complement"), std::string::npos);
  EXPECT_NE(message(Operation::intersect, {left, nullptr}).find("solid = null"), std::string::npos);
  const CombineOptions flat = with(Blending::super_elliptic, 0), broken = with(Blending::log_sum_exp, NAN);
  EXPECT_NE(message(Operation::unite, {left, right}, flat).find("radius = 0"), std::string::npos);
  EXPECT_NE(message(Operation::unite, {left, right}, broken).find("radius = nan"), std::string::npos);
  const CombineOptions blunt = with(Blending::super_elliptic, 0.1, 0.5);
  EXPECT_NE(message(Operation::unite, {left, right}, blunt).find("sharpness = 0.5"), std::string::npos);
}

}  // namespace
}  // namespace csrbf::combine_test
