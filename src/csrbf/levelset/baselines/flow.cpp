#include "csrbf/levelset/baselines/flow.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/samples/spacing.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/levelset/baselines/node_system.hpp"

#include <numbers>

namespace csrbf {
namespace {

constexpr const char* flow_function = "flow";

// Of the differentiation matrix along an axis, times the node spacing: 1.8 to 2.1 for supports of 2.8 to 7 spacings.
constexpr double gradient_radius = 2.1;

// Of the laplacian over the squared node spacing and per axis: pi^2 for exact waves, 10.3 with four derivatives and
// more, up to 16 with two.
double laplacian_radius(const Kernel& kernel) {
  return kernel.smoothness() >= 4 ? 11 : 16;
}

// How far the stability regions reach along the imaginary and the negative real axis: their known limits, sqrt(3) and
// 2.51 for order 3, sqrt(8) and 2.785 for order 4.
struct Reach {
  double imaginary, real;
};

Reach reach_of(FlowIntegrator integrator) {
  return integrator == FlowIntegrator::rk4 ? Reach{2.83, 2.78} : Reach{1.73, 2.51};
}

void check_flow(const FlowOptions& o, double duration, double curvature, double diffusion) {
  require(duration >= 0 && std::isfinite(duration), flow_function, "duration", duration, "must not be negative");
  require(o.support > 1 && std::isfinite(o.support), flow_function, "support", o.support,
          "must be above 1 (node spacing)");
  require(o.eps > 0 && std::isfinite(o.eps), flow_function, "eps", o.eps, "must be positive");
  require(o.time_step >= 0 && std::isfinite(o.time_step), flow_function, "time_step", o.time_step,
          "must not be negative");
  require(curvature >= 0 && std::isfinite(curvature), flow_function, "law.curvature", curvature,
          "must not be negative");
  require(diffusion >= 0 && std::isfinite(diffusion), flow_function, "law.diffusion", diffusion,
          "must not be negative");
  require(o.integrator != FlowIntegrator::semi_implicit || curvature + diffusion > 0, flow_function, "integrator",
          "semi_implicit", "needs curvature or diffusion; take ssp_rk3 or rk4");
}

// Mean over the nodes on the faces of their bounding box.
template <int Dim>
double rim_mean(const Points<Dim>& points, const Eigen::VectorXd& values, double margin) {
  const Box<Dim> box = bounding_box<Dim>(points);
  double sum = 0;
  Index count = 0;
  for (Index i = 0; i < points.cols(); ++i) {
    const Point<Dim> p = points.col(i);
    if ((p - box.lo).minCoeff() >= margin && (box.hi - p).minCoeff() >= margin) continue;
    sum += values[i];
    ++count;
  }
  return sum / static_cast<double>(count);
}

template <int Dim>
class Mover {
 public:
  Mover(const Nodes<Dim>& nodes, const Field<Dim>& start, const FlowLaw<Dim>& law, const FlowOptions& options)
      : nodes_(nodes), law_(law), options_(options), kernel_(options.kernel, Dim) {
    require(kernel_.order() == 0 && kernel_.smoothness() >= 2, flow_function, "kernel", kernel_.name(),
            "must be positive definite and have two derivatives");
    h_ = nodes.regular() ? 2 * fill_distance<Dim>(nodes, nodes.points) / std::sqrt(static_cast<double>(Dim))
                         : center_spacing<Dim>(nodes.points, nodes.points);
    system_.emplace(nodes, kernel_, options.support * h_);
    values_ = start.evaluate(nodes.points).value;
    require(values_.allFinite(), flow_function, "start", values_.sum(), "must be finite at all nodes");
    constant_ = rim_mean<Dim>(nodes.points, values_, 0.5 * h_);
  }

  FlowResult<Dim> run(double duration) {
    FlowResult<Dim> result;
    double time = 0;
    while (time < duration) {
      report(options_.progress, "flow", time / duration);
      const double tau = next_step(time, duration - time);
      step(time, tau);
      time = tau >= duration - time ? duration : time + tau;
      ++result.steps;
      result.largest_step = std::max(result.largest_step, tau);
      if (!values_.allFinite()) throw SolverFailure("flow: values grew beyond all bounds; the law is not stable");
    }
    result.field = system_->expansion(coefficients(values_), {}, constant_);
    result.values = values_;
    return result;
  }

 private:
  [[nodiscard]] Eigen::VectorXd coefficients(const Eigen::VectorXd& s) const {
    return system_->solve(s.array() - constant_);
  }

  // f_t at the nodes, and the terms of it that the step depends on.
  struct Rate {
    Eigen::VectorXd total, laplacian;
    double speed = 0;  // largest, along and across the contour
    double force = 0;
  };

  [[nodiscard]] Rate rate(const Eigen::VectorXd& s, double time) const {
    const auto f = system_->expansion(coefficients(s), {}, constant_);
    const Jet<Dim> jet = f->evaluate(nodes_.points, Derivatives::hessian);
    const Index n = s.size();
    Rate rate{Eigen::VectorXd::Zero(n), Eigen::VectorXd(n)};
    // |grad f| div(grad f / |grad f|) = laplacian - n.H n; where the gradient vanishes the mean over all n.
    constexpr double vanishing = 1e-6;  // of the largest gradient: below, it has no direction; by hand
    const double least2 = vanishing * vanishing * jet.gradient.colwise().squaredNorm().maxCoeff();
    Eigen::VectorXd bending(n), curvature(n);
    const Eigen::VectorXd correction = system_->laplacian_bias() / Dim * (s.array() - constant_);
    for (Index i = 0; i < n; ++i) {
      Eigen::Matrix<double, Dim, Dim> H = jet.hessian_matrix(i);
      H.diagonal().array() += correction[i];
      const Point<Dim> g = jet.gradient.col(i);
      const double norm2 = g.squaredNorm() + least2;
      rate.laplacian[i] = H.trace();
      bending[i] = norm2 > 0 ? H.trace() - (g.dot(H * g) + least2 / Dim * H.trace()) / norm2 : 0;
      curvature[i] = norm2 > 0 ? -bending[i] / std::sqrt(norm2) : 0;
    }
    add_terms({nodes_.points, s, jet.gradient, curvature, time}, rate);
    rate.total += law_.curvature * bending + law_.diffusion * rate.laplacian;
    return rate;
  }

  void add_terms(const FlowState<Dim>& state, Rate& rate) const {
    const Index n = state.value.size();
    Eigen::VectorXd out(n);
    if (law_.force) {
      law_.force(state, out);
      const double eps = options_.eps * h_;
      rate.total.array() -= out.array() / (std::numbers::pi * eps * (1 + (state.value.array() / eps).square()));
      rate.force = out.cwiseAbs().maxCoeff();
    }
    if (law_.speed) {
      law_.speed(state, out);
      rate.total += out.cwiseProduct(state.gradient.colwise().norm().transpose());
      rate.speed += out.cwiseAbs().maxCoeff();
    }
    if (law_.velocity) {
      Points<Dim> v(Dim, n);
      law_.velocity(state, v);
      rate.total -= v.cwiseProduct(state.gradient).colwise().sum().transpose();
      rate.speed += v.colwise().norm().maxCoeff();
    }
  }

  // The largest stable step, infinite when there is none.
  [[nodiscard]] double stable_step(const Rate& rate) const {
    const double mu = law_.curvature + law_.diffusion;
    const Reach reach = reach_of(options_.integrator);
    const bool implicit = options_.integrator == FlowIntegrator::semi_implicit;
    const double waves = std::sqrt(static_cast<double>(Dim)) * gradient_radius * rate.speed / (reach.imaginary * h_);
    const double decay = implicit ? 0 : Dim * laplacian_radius(kernel_) * mu / (reach.real * h_ * h_);
    // Euler with diffusion behind it: |1 + i tau k v| <= 1 + tau mu k^2 for all k.
    const double euler = implicit ? rate.speed * rate.speed / (2 * mu) : 0;
    const double change = rate.force / (std::numbers::pi * options_.eps * h_ * h_);
    return 1 / std::max({waves + decay, euler, change});
  }

  [[nodiscard]] double next_step(double time, double remaining) {
    rate_ = rate(values_, time);
    require(std::isfinite(rate_.speed) && std::isfinite(rate_.force), flow_function, "velocity",
            rate_.speed + rate_.force, "must be finite at all nodes");
    const double stable = stable_step(rate_);
    double tau = options_.time_step;
    if (tau > 0) {
      require(tau <= stable, flow_function, "time_step", tau,
              "must be at most " + std::to_string(stable) + " to be stable");
    } else {
      tau = 0.9 * stable;
      if (options_.integrator == FlowIntegrator::semi_implicit)
        tau = std::min(tau, 0.25 * h_ * h_ / (law_.curvature + law_.diffusion));
    }
    // Equal steps to the end, so that the implicit matrix changes rarely.
    return tau < remaining ? remaining / std::ceil(remaining / tau * (1 - 1e-9)) : remaining;
  }

  // One step from values_ with their rate in rate_.
  void step(double time, double tau) {
    const Eigen::VectorXd& s = values_;
    if (options_.integrator == FlowIntegrator::semi_implicit) {
      const double mu = law_.curvature + law_.diffusion;
      if (!implicit_ || std::abs(tau - implicit_step_) > 1e-6 * tau) {
        implicit_.emplace(nodes_, kernel_, options_.support * h_, tau * mu);
        implicit_step_ = tau;
      }
      const Eigen::VectorXd right = s.array() - constant_ + tau * (rate_.total - mu * rate_.laplacian).array();
      values_ = system_->multiply(implicit_->solve(right)).array() + constant_;
    } else if (options_.integrator == FlowIntegrator::ssp_rk3) {
      const Eigen::VectorXd one = s + tau * rate_.total;
      const Eigen::VectorXd two = .75 * s + .25 * (one + tau * rate(one, time + tau).total);
      values_ = s / 3 + 2.0 / 3 * (two + tau * rate(two, time + .5 * tau).total);
    } else {
      const Eigen::VectorXd k2 = rate(s + .5 * tau * rate_.total, time + .5 * tau).total;
      const Eigen::VectorXd k3 = rate(s + .5 * tau * k2, time + .5 * tau).total;
      const Eigen::VectorXd k4 = rate(s + tau * k3, time + tau).total;
      values_ += tau / 6 * (rate_.total + 2 * k2 + 2 * k3 + k4);
    }
  }

  const Nodes<Dim>& nodes_;
  const FlowLaw<Dim>& law_;
  const FlowOptions& options_;
  Kernel kernel_;
  double h_ = 1, constant_ = 0, implicit_step_ = 0;
  std::optional<NodeSystem<Dim>> system_, implicit_;
  Eigen::VectorXd values_;
  Rate rate_;
};

}  // namespace

template <int Dim>
FlowResult<Dim> flow(const Nodes<Dim>& nodes, const Field<Dim>& start, double duration, const FlowLaw<Dim>& law,
                     const FlowOptions& options) {
  check_flow(options, duration, law.curvature, law.diffusion);
  return Mover<Dim>(nodes, start, law, options).run(duration);
}

template FlowResult<2> flow<2>(const Nodes<2>&, const Field<2>&, double, const FlowLaw<2>&, const FlowOptions&);
template FlowResult<3> flow<3>(const Nodes<3>&, const Field<3>&, double, const FlowLaw<3>&, const FlowOptions&);

}  // namespace csrbf
