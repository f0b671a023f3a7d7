#include "csrbf/levelset/baselines/collocation.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/levelset/baselines/node_system.hpp"
#include "csrbf/levelset/baselines/voxel_sampler.hpp"
#include "csrbf/levelset/image/label_gap.hpp"
#include "csrbf/levelset/image/signed_distance.hpp"
#include "csrbf/levelset/lattice/lattice_field.hpp"

#include <Eigen/Geometry>

#include <chrono>
#include <numbers>

namespace csrbf {
namespace {

constexpr const char* here = "collocate";
// Converged when labels rest while the fastest values change by this many node spacings, and for at least so many
// iterations, as small steps take a while to change any label. By hand.
constexpr int rest_iterations = 3;

class Stopwatch {
 public:
  // Adds the time since the last call.
  void lap(double& seconds) {
    const auto now = std::chrono::steady_clock::now();
    seconds += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void check(const Grid& grid, const CollocationOptions& o, int dim) {
  require(grid.dimension() <= dim, here, "dimension of the image", grid.dimension(), "must be that of the nodes");
  require(o.support >= 0 && std::isfinite(o.support), here, "support", o.support, "must be positive, or 0");
  require(o.largest_value > 0, here, "largest_value", o.largest_value, "must be positive");
  require(o.eps >= 0 && std::isfinite(o.eps), here, "eps", o.eps, "must be positive, or 0");
  require(o.step > 0 && std::isfinite(o.step), here, "step", o.step, "must be positive");
  require(o.iterations >= 0, here, "iterations", o.iterations, "must not be negative");
  require(o.tolerance >= 0, here, "tolerance", o.tolerance, "must not be negative");
}

template <int Dim>
class Collocation {
 public:
  Collocation(const Grid& grid, const Nodes<Dim>& nodes, const ForceUpdate& force, const CollocationOptions& options)
      : options_(options), force_(force), kernel_(options.kernel, Dim, options.parameter) {
    check(grid, options, Dim);
    const Points<Dim> voxels = grid.centers<Dim>();
    const double fill = fill_distance<Dim>(nodes, voxels);
    const double h = 2 * fill / std::sqrt(static_cast<double>(Dim));  // as on a regular grid
    const double rho = options.support > 0 ? options.support : kernel_.compact() ? 4 : 1;
    result_.support = rho * fill;  // eq. (8.17)
    if (!kernel_.has_scale()) result_.support = 0.5 * bounding_box<Dim>(nodes.points).extent().maxCoeff();
    Stopwatch watch;
    system_.emplace(nodes, kernel_, result_.support);
    watch.lap(result_.system_seconds);
    sampler_.emplace(system_->basis(), voxels);
    watch.lap(result_.evaluate_seconds);
    averages_ =
        velocity_weights<Dim>(grid, nodes.points, options.sampling == VelocitySampling::kernel_average ? h : 0.0);
    watch.lap(result_.force_seconds);
    bound_ = options.largest_value * h;
    result_.node_spacing = h;
    const double wide = options.bound == LevelSetBound::l1_norm ? 2 * result_.support : bound_;
    result_.eps = options.eps > 0 ? options.eps * h : wide;
    result_.tau = options.step * h * std::numbers::pi * result_.eps;
    box_ = image_box<Dim>(grid);
    labels_size_ = grid.voxels();
  }

  CollocationResult<Dim> run(const Eigen::VectorXd& start) {
    Stopwatch watch;
    const bool clipped = options_.bound != LevelSetBound::l1_norm;  // scaled down it would be flat at the contour
    mu_ = system_->solve(clipped ? Eigen::VectorXd(start.cwiseMax(-bound_).cwiseMin(bound_)) : start);
    limit();
    watch.lap(result_.solve_seconds);
    result_.labels.assign(labels_size_, 0);
    sampler_->labels(*system_, mu_, result_.labels.data());
    watch.lap(result_.evaluate_seconds);
    std::vector<float> force(result_.labels.size());
    const double rest_needed = std::max(1.0, 1 / options_.step) * rest_iterations;
    for (int resting = 0; result_.iterations < options_.iterations && !result_.converged; ++result_.iterations) {
      report(options_.progress, "evolve",
             static_cast<double>(result_.iterations) / static_cast<double>(options_.iterations));
      force_(result_.labels.data(), force.data());
      const Eigen::VectorXd V = velocity(force);
      watch.lap(result_.force_seconds);
      step(V);
      watch.lap(result_.solve_seconds);
      const Index changed = sampler_->labels(*system_, mu_, result_.labels.data());
      watch.lap(result_.evaluate_seconds);
      result_.changes.push_back(changed);
      result_.gaps.push_back(label_gap(result_.labels, force));
      const bool rests = static_cast<double>(changed) <= options_.tolerance * static_cast<double>(labels_size_);
      resting = rests ? resting + 1 : 0;
      result_.converged = resting >= rest_needed;
    }
    result_.field = system_->expansion(mu_, box_);
    return std::move(result_);
  }

 private:
  // V at the nodes, scaled to max |V| = 1.
  [[nodiscard]] Eigen::VectorXd velocity(const std::vector<float>& force) const {
    const Eigen::Map<const Eigen::VectorXf> forces(force.data(), std::ssize(force));
    Eigen::VectorXd V(averages_.rows());
    parallel_for(V.size(), 4096, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        double sum = 0;
        for (typename Averages::InnerIterator it(averages_, i); it; ++it)
          sum += static_cast<double>(it.value()) * static_cast<double>(forces[it.col()]);
        V[i] = sum;
      }
    });
    const double largest = V.cwiseAbs().maxCoeff();
    require(std::isfinite(largest), here, "force", largest, "must be finite on all voxels");
    return largest > 0 ? Eigen::VectorXd(V / largest) : V;
  }

  void step(const Eigen::VectorXd& V) {
    const Eigen::VectorXd f = system_->multiply(mu_);
    const double eps = result_.eps;
    const Eigen::VectorXd B =
        V.array() / (std::numbers::pi * eps * (1 + (f.array() / eps).square()));  // eqs. (7.12), (8.14)
    const Eigen::VectorXd before = mu_;
    mu_ -= result_.tau * system_->solve(B);  // eqs. (8.25)-(8.27)
    limit();
    result_.coefficient_changes.push_back((mu_ - before).template lpNorm<Eigen::Infinity>());
  }

  // Eq. (8.28), or instead of it: the polynomial is scaled as well, so that the contour stays.
  void limit() {
    if (options_.bound == LevelSetBound::l1_norm) {
      const double norm = mu_.head(system_->nodes()).template lpNorm<1>();
      if (norm > 0) mu_ *= result_.support / norm;
    } else if (options_.bound == LevelSetBound::cap) {
      const double largest = system_->multiply(mu_).cwiseAbs().maxCoeff();
      if (largest > bound_) mu_ *= bound_ / largest;
    }
  }

  using Averages = Eigen::SparseMatrix<float, Eigen::RowMajor>;

  CollocationOptions options_;
  const ForceUpdate& force_;
  Kernel kernel_;
  std::optional<NodeSystem<Dim>> system_;
  std::optional<VoxelSampler<Dim>> sampler_;
  Averages averages_;
  double bound_ = 0;
  Box<Dim> box_;
  Index labels_size_ = 0;
  Eigen::VectorXd mu_;
  CollocationResult<Dim> result_;
};

}  // namespace

template <int Dim>
CollocationResult<Dim> collocate(const Grid& grid, const Nodes<Dim>& nodes, const Field<Dim>& start,
                                 const ForceUpdate& force, const CollocationOptions& options) {
  return Collocation<Dim>(grid, nodes, force, options).run(start.evaluate(nodes.points).value);
}

template <int Dim>
CollocationResult<Dim> collocate(const Grid& grid, const Nodes<Dim>& nodes, const unsigned char* start,
                                 const ForceUpdate& force, const CollocationOptions& options) {
  Collocation<Dim> scheme(grid, nodes, force, options);
  const std::vector<float> distance = signed_distance(grid, start);
  const auto weights = linear_weights<Dim>(grid, nodes.points);
  return scheme.run(weights * Eigen::Map<const Eigen::VectorXf>(distance.data(), grid.voxels()).cast<double>());
}

#define CSRBF_INSTANTIATE(Dim)                                                                         \
  template CollocationResult<Dim> collocate<Dim>(const Grid&, const Nodes<Dim>&, const Field<Dim>&,    \
                                                 const ForceUpdate&, const CollocationOptions&);       \
  template CollocationResult<Dim> collocate<Dim>(const Grid&, const Nodes<Dim>&, const unsigned char*, \
                                                 const ForceUpdate&, const CollocationOptions&);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
