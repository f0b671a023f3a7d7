#include "csrbf/levelset/baselines/flow.hpp"

#include "core/error_testing.hpp"
#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/levelset/baselines/node_system.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace csrbf::flow_test {
namespace {

constexpr double pi = std::numbers::pi;

template <int Dim>
class FieldOf : public Field<Dim> {
 public:
  explicit FieldOf(std::function<double(const Point<Dim>&)> f) : f_(std::move(f)) {}
  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override {
    for (Index i = 0; i < x.cols(); ++i) out.value[i] = f_(x.col(i));
  }
  [[nodiscard]] Box<Dim> bounds() const override { return {}; }

 private:
  std::function<double(const Point<Dim>&)> f_;
};

// exp(-|p - c|^2 / (2 w^2)) less its value at distance r: smooth, flat far away, zero on the circle (sphere).
template <int Dim>
class Bump : public FieldOf<Dim> {
 public:
  Bump(const Point<Dim>& center, double radius, double width)
      : FieldOf<Dim>([=](const Point<Dim>& p) {
          const auto profile = [width](double r2) { return std::exp(-r2 / (2 * width * width)); };
          return profile((p - center).squaredNorm()) - profile(radius * radius);
        }) {}
};

template <int Dim>
Nodes<Dim> cube_nodes(Index n) {
  std::array<Index, Dim> counts;
  counts.fill(n);
  Box<Dim> box;
  box.add(Point<Dim>::Constant(-1));
  box.add(Point<Dim>::Constant(1));
  return regular_nodes<Dim>(box, counts);
}

// Smallest and largest distance of the zero set from the centre, along rays.
template <int Dim>
std::pair<double, double> radii(const Field<Dim>& field, const Point<Dim>& center) {
  std::pair<double, double> range{1e9, 0};
  for (int i = 0; i < 48; ++i) {
    Point<Dim> ray = Point<Dim>::Zero();
    ray[0] = std::cos(2 * pi * i / 48);
    ray[1] = std::sin(2 * pi * i / 48);
    if constexpr (Dim == 3) {
      ray *= std::cos(.3 * i);
      ray[2] = std::sin(.3 * i);
    }
    double lo = 0, hi = .95;
    for (int k = 0; k < 50; ++k) {
      const double middle = .5 * (lo + hi);
      (field(center + middle * ray) > 0 ? lo : hi) = middle;
    }
    range.first = std::min(range.first, lo);
    range.second = std::max(range.second, lo);
  }
  return range;
}

template <int Dim>
double radius_error(const Field<Dim>& field, double radius, const Point<Dim>& center = Point<Dim>::Zero()) {
  const auto [least, most] = radii<Dim>(field, center);
  return std::max(std::abs(least - radius), std::abs(most - radius));
}

FlowLaw<2> outwards(double speed) {
  FlowLaw<2> law;
  law.speed = [speed](const FlowState<2>&, Eigen::VectorXd& out) { out.setConstant(speed); };
  return law;
}

// Supports of a fixed radius: the fixed number of neighbours of the default has a floor of its own.
FlowOptions fixed_support(double radius, Index n, FlowIntegrator integrator = FlowIntegrator::ssp_rk3) {
  FlowOptions options;
  options.support = radius * static_cast<double>(n - 1) / 2;
  options.integrator = integrator;
  return options;
}

double order(double coarse, double fine) {
  return std::log2(coarse / fine);
}

TEST(Flow, StaysWhereItIsInNoTime) {
  const Nodes<2> nodes = cube_nodes<2>(21);
  const Bump<2> start(Point<2>::Zero(), .5, .25);
  const FlowResult<2> result = flow<2>(nodes, start, 0, outwards(1));
  EXPECT_EQ(result.steps, 0);
  EXPECT_EQ(result.values, start.evaluate(nodes.points).value);
  EXPECT_LT((result.field->evaluate(nodes.points).value - result.values).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Flow, GrowsACircleAtUnitSpeed) {
  std::array<double, 2> error{};
  for (std::size_t i = 0; i < 2; ++i) {
    const Index n = i == 0 ? 21 : 41;
    const FlowResult<2> result = flow<2>(cube_nodes<2>(n), Bump<2>(Point<2>::Zero(), .3, .25), .2, outwards(1));
    error[i] = radius_error<2>(*result.field, .5);
  }
  EXPECT_LT(error[1], 2e-3);
  EXPECT_GT(order(error[0], error[1]), 1.9) << error[0] << " " << error[1];
}

// All level sets shrink into the centre and make a corner there, whose ripples reach the contour.
TEST(Flow, ShrinksACircleAtNegativeSpeed) {
  constexpr double node_spacing = .05;
  const FlowResult<2> result = flow<2>(cube_nodes<2>(41), Bump<2>(Point<2>::Zero(), .5, .25), .15, outwards(-1));
  EXPECT_LT(radius_error<2>(*result.field, .35), .25 * node_spacing);
}

TEST(Flow, ShrinksACircleByItsCurvature) {
  FlowLaw<2> law;
  law.curvature = 1;
  const double t = .06, radius = std::sqrt(.25 - 2 * t);
  std::array<double, 3> error{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Index n = std::array<Index, 3>{9, 17, 33}[i];
    error[i] = radius_error<2>(
        *flow<2>(cube_nodes<2>(n), Bump<2>(Point<2>::Zero(), .5, .25), t, law, fixed_support(.4, n)).field, radius);
  }
  EXPECT_LT(error[2], 1e-4);
  EXPECT_GT(order(error[0], error[1]), 2) << error[0] << " " << error[1] << " " << error[2];
  EXPECT_GT(order(error[1], error[2]), 2) << error[1] << " " << error[2];
}

TEST(Flow, ShrinksASphereByItsCurvatures) {
  FlowLaw<3> law;
  law.curvature = 1;
  const double t = .02, radius = std::sqrt(.25 - 4 * t);
  FlowOptions options;
  options.support = 4.5;
  const FlowResult<3> result = flow<3>(cube_nodes<3>(15), Bump<3>(Point<3>::Zero(), .5, .3), t, law, options);
  EXPECT_LT(radius_error<3>(*result.field, radius), 5e-3);
}

TEST(Flow, CarriesADiscAndBringsItBack) {
  FlowLaw<2> law;
  law.velocity = [](const FlowState<2>& state, Points<2>& out) {
    const double v = std::cos(pi * state.time / .8);
    for (Index i = 0; i < out.cols(); ++i) out.col(i) = v * Point<2>(1, .5);
  };
  const Bump<2> start(Point<2>(-.15, 0), .2, .15);
  for (const FlowIntegrator integrator : {FlowIntegrator::ssp_rk3, FlowIntegrator::rk4}) {
    FlowOptions options;
    options.integrator = integrator;
    const FlowResult<2> half = flow<2>(cube_nodes<2>(41), start, .4, law, options);
    const double way = .8 / pi;
    EXPECT_LT(radius_error<2>(*half.field, .2, Point<2>(-.15 + way, .5 * way)), 2e-3);
    const FlowResult<2> there = flow<2>(cube_nodes<2>(41), start, .8, law, options);
    EXPECT_LT((there.values - start.evaluate(cube_nodes<2>(41).points).value).cwiseAbs().maxCoeff(), 2e-2);
    EXPECT_LT(radius_error<2>(*there.field, .2, Point<2>(-.15, 0)), 2e-3);
  }
}

FlowLaw<2> full_turn() {
  FlowLaw<2> law;
  law.velocity = [](const FlowState<2>& state, Points<2>& out) {
    out.row(0) = -2 * pi * state.points.row(1);
    out.row(1) = 2 * pi * state.points.row(0);
  };
  return law;
}

TEST(Flow, TurnsADiscBackToWhereItWas) {
  const Bump<2> start(Point<2>(.35, 0), .2, .16);
  for (const FlowIntegrator integrator : {FlowIntegrator::ssp_rk3, FlowIntegrator::rk4}) {
    std::array<double, 2> error{};
    for (std::size_t i = 0; i < 2; ++i) {
      const Index n = i == 0 ? 15 : 29;
      const FlowResult<2> result = flow<2>(cube_nodes<2>(n), start, 1, full_turn(), fixed_support(.5, n, integrator));
      error[i] = radius_error<2>(*result.field, .2, Point<2>(.35, 0));
    }
    EXPECT_LT(error[1], 1e-3);
    EXPECT_GT(order(error[0], error[1]), 2) << error[0] << " " << error[1];
  }
}

TEST(Flow, HasTheOrderOfItsIntegratorInTime) {
  const Nodes<2> nodes = cube_nodes<2>(17);
  const Bump<2> start(Point<2>(.3, 0), .2, .3);
  struct Case {
    FlowIntegrator integrator;
    double theory;
  };
  for (const Case& c : {Case{FlowIntegrator::ssp_rk3, 3}, Case{FlowIntegrator::rk4, 4}}) {
    std::array<Eigen::VectorXd, 4> values;
    for (std::size_t i = 0; i < 4; ++i) {
      FlowOptions options;
      options.integrator = c.integrator;
      options.time_step = i == 3 ? 1.0 / 4096 : 1.0 / (256 << i);
      values[i] = flow<2>(nodes, start, .25, full_turn(), options).values;
    }
    const double coarse = (values[0] - values[3]).norm(), middle = (values[1] - values[3]).norm(),
                 fine = (values[2] - values[3]).norm();
    EXPECT_GT(order(coarse, middle), c.theory - .1);
    EXPECT_GT(order(middle, fine), c.theory - .1);
  }
  std::array<double, 3> error{};
  FlowLaw<2> law;
  law.curvature = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    FlowOptions options = fixed_support(.4, 29, FlowIntegrator::semi_implicit);
    options.time_step = .004 / (1 << i);
    error[i] =
        radius_error<2>(*flow<2>(cube_nodes<2>(29), Bump<2>(Point<2>::Zero(), .5, .25), .064, law, options).field,
                        std::sqrt(.25 - 2 * .064));
  }
  EXPECT_GT(order(error[0], error[1]), .8);
  EXPECT_GT(order(error[1], error[2]), .8);
}

TEST(Flow, IsStableWithCurvatureForAnyStepWhenSemiImplicit) {
  const Nodes<2> nodes = cube_nodes<2>(33);
  const Bump<2> start(Point<2>::Zero(), .5, .25);
  FlowLaw<2> law;
  law.curvature = 1;
  const double largest = start.evaluate(nodes.points).value.cwiseAbs().maxCoeff();
  for (const double tau : {.01, 1.0, 100.0}) {  // the bound of explicit steps is 4e-4
    FlowOptions options;
    options.integrator = FlowIntegrator::semi_implicit;
    options.time_step = tau;
    const FlowResult<2> result = flow<2>(nodes, start, 30 * tau, law, options);
    EXPECT_EQ(result.steps, 30);
    EXPECT_LT(result.values.cwiseAbs().maxCoeff(), 1.01 * largest);
  }
}

TEST(Flow, DampsEveryStateByDiffusion) {
  const Nodes<2> nodes = cube_nodes<2>(17);
  const FieldOf<2> noise([](const Point<2>& p) { return std::sin(1e4 * p[0] + 3e4 * p[1]); });
  FlowLaw<2> law;
  law.diffusion = 1;
  for (const double tau : {1e-4, 1e-2, 1.0}) {
    FlowOptions options;
    options.integrator = FlowIntegrator::semi_implicit;
    options.time_step = tau;
    // |f - c| in the norm of the kernel can only fall: (H - tau L)^-1 H has its spectrum in (0, 1].
    const NodeSystem<2> system(nodes, Kernel(options.kernel, 2), options.support / 8);
    double before = std::numeric_limits<double>::infinity();
    for (int steps = 0; steps < 4; ++steps) {
      const FlowResult<2> result = flow<2>(nodes, noise, steps * tau, law, options);
      const Eigen::VectorXd& alpha = dynamic_cast<const Expansion<2>&>(*result.field).coefficients();
      const double now = alpha.dot(system.multiply(alpha));
      EXPECT_LT(now, before);
      before = now;
    }
  }
}

TEST(Flow, FollowsAForceOnlyWhereDeltaReaches) {
  const Nodes<2> nodes = cube_nodes<2>(33);
  const Bump<2> start(Point<2>::Zero(), .5, .25);
  FlowLaw<2> law;
  law.force = [](const FlowState<2>&, Eigen::VectorXd& out) { out.setConstant(-1); };
  FlowOptions options;
  const double h = 1.0 / 16, eps = options.eps * h, t = .002;
  const FlowResult<2> result = flow<2>(nodes, start, t, law, options);
  // At the node of largest value: f_t = delta_eps(f), nearly constant over so short a time.
  const Eigen::VectorXd before = start.evaluate(nodes.points).value;
  Index top = 0;
  const double f = before.maxCoeff(&top);
  EXPECT_NEAR(result.values[top] - f, t / (pi * eps * (1 + f * f / (eps * eps))), 1e-5);
  EXPECT_TRUE(((result.values - before).array() > 0).all());
}

TEST(Flow, GivesVelocitiesTheCurvatureOfEachLevelSet) {
  const Nodes<2> nodes = cube_nodes<2>(41);
  FlowLaw<2> law;
  bool seen = false;
  law.speed = [&](const FlowState<2>& state, Eigen::VectorXd& out) {
    for (Index i = 0; i < out.size(); ++i) {
      const double r = state.points.col(i).norm();
      if (r <= .2 || r >= .6) continue;
      EXPECT_NEAR(state.curvature[i] * r, 1, .02);
    }
    seen = true;
    out.setZero();
  };
  static_cast<void>(flow<2>(nodes, Bump<2>(Point<2>::Zero(), .5, .25), 1e-3, law));
  EXPECT_TRUE(seen);
}

TEST(Flow, MovesScatteredNodes) {
  Nodes<2> nodes = cube_nodes<2>(33);
  nodes.size = {};
  for (Index i = 0; i < nodes.points.cols(); ++i) {
    const double k = static_cast<double>(i);
    nodes.points.col(i) += .012 * Point<2>(std::sin(7 * k), std::cos(11 * k));
  }
  const FlowResult<2> result = flow<2>(nodes, Bump<2>(Point<2>::Zero(), .3, .25), .15, outwards(1));
  EXPECT_LT(radius_error<2>(*result.field, .45), 5e-3);
}

TEST(Flow, DoesNotDependOnTheNumberOfThreads) {
  const Bump<2> start(Point<2>::Zero(), .5, .25);
  FlowLaw<2> law = outwards(.5);
  law.curvature = .1;
  set_thread_count(1);
  const Eigen::VectorXd one = flow<2>(cube_nodes<2>(55), start, .003, law).values;
  set_thread_count(3);
  const Eigen::VectorXd three = flow<2>(cube_nodes<2>(55), start, .003, law).values;
  set_thread_count(0);
  EXPECT_EQ(one, three);
}

TEST(Flow, RefusesInvalidOptions) {
  const Nodes<2> nodes = cube_nodes<2>(11);
  const Bump<2> start(Point<2>::Zero(), .5, .25);
  const auto message = [&](auto change, double duration = .1) {
    FlowOptions options;
    FlowLaw<2> law = outwards(1);
    change(options, law);
    return invalid_input_message([&] { static_cast<void>(flow<2>(nodes, start, duration, law, options)); });
  };
  using O = FlowOptions;
  using L = FlowLaw<2>;
  EXPECT_NE(message([](O&, L&) {}, -1).find("duration = -1"), std::string::npos);
  EXPECT_NE(message([](O& o, L&) { o.support = 1; }).find("support = 1"), std::string::npos);
  EXPECT_NE(message([](O& o, L&) { o.eps = 0; }).find("eps = 0"), std::string::npos);
  EXPECT_NE(message([](O& o, L&) { o.kernel = "wendland-c0"; }).find("kernel = wendland-c0"), std::string::npos);
  EXPECT_NE(message([](O& o, L&) { o.kernel = "thin-plate"; }).find("kernel = thin-plate"), std::string::npos);
  EXPECT_NE(message([](O& o, L&) { o.time_step = -1; }).find("time_step = -1"), std::string::npos);
  EXPECT_NE(message([](O& o, L&) { o.time_step = 1; }).find("to be stable"), std::string::npos);
  EXPECT_NE(message([](O&, L& l) { l.curvature = -1; }).find("law.curvature = -1"), std::string::npos);
  EXPECT_NE(message([](O&, L& l) { l.diffusion = -1; }).find("law.diffusion = -1"), std::string::npos);
  EXPECT_NE(message([](O& o, L&) { o.integrator = FlowIntegrator::semi_implicit; }).find("needs curvature"),
            std::string::npos);
  EXPECT_NE(message([](O&, L& l) {
              l.speed = [](const FlowState<2>&, Eigen::VectorXd& out) { out.setConstant(std::nan("")); };
            }).find("velocity"),
            std::string::npos);
}

TEST(Flow, CanBeCancelled) {
  FlowOptions options;
  options.progress = [](std::string_view, double) { return false; };
  EXPECT_THROW(
      static_cast<void>(flow<2>(cube_nodes<2>(9), Bump<2>(Point<2>::Zero(), .5, .25), 1, outwards(1), options)),
      Cancelled);
}

}  // namespace
}  // namespace csrbf::flow_test
