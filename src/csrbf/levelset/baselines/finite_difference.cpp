#include "csrbf/levelset/baselines/finite_difference.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/levelset/baselines/dense_level_set.hpp"
#include "csrbf/levelset/image/label_gap.hpp"
#include "csrbf/levelset/image/signed_distance.hpp"
#include "csrbf/levelset/lattice/lattice_field.hpp"
#include "csrbf/linalg/toeplitz_system.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

constexpr const char* finite_difference_function = "finite_difference";
constexpr int window = 20;  // iterations, ten voxels of motion at most, over which labels must rest; by hand

void check_finite_difference(const Grid& grid, const FiniteDifferenceOptions& o, int dim) {
  require(grid.dimension() == dim, finite_difference_function, "dimension of the image", grid.dimension(),
          "must be that of the level set: 2 or more voxels along each axis");
  require(o.length >= 0 && std::isfinite(o.length), finite_difference_function, "length", o.length,
          "must not be negative");
  require(o.band == 0 || o.band >= 3, finite_difference_function, "band", o.band, "must be at least 3, or 0");
  require(o.reinitialize_every >= 0, finite_difference_function, "reinitialize_every", o.reinitialize_every,
          "must not be negative");
  require(o.reinitialize_every > 0 || o.band == 0, finite_difference_function, "reinitialize_every",
          o.reinitialize_every, "must be positive with a band, which follows the contour only then");
  require(o.penalty >= 0 && std::isfinite(o.penalty), finite_difference_function, "penalty", o.penalty,
          "must not be negative");
  require(o.iterations >= 0, finite_difference_function, "iterations", o.iterations, "must not be negative");
  require(o.tolerance >= 0, finite_difference_function, "tolerance", o.tolerance, "must not be negative");
}

// -force / max |force| into `speed`; returns the largest speed, 1 or 0.
double speed_of(const std::vector<float>& force, std::vector<float>& speed) {
  float largest = 0;
  for (const float V : force) {
    require(std::isfinite(V), finite_difference_function, "force", V, "must be finite on all voxels");
    largest = std::max(largest, std::abs(V));
  }
  if (largest == 0) largest = std::numeric_limits<float>::infinity();
  std::transform(force.begin(), force.end(), speed.begin(), [largest](float V) { return -V / largest; });
  return std::isfinite(largest) ? 1 : 0;
}

// An ellipsoidal Wendland function on each voxel, of equal radius in voxels along all axes.
template <int Dim>
std::shared_ptr<const LatticeField<Dim>> interpolate_values(const Grid& grid, const std::vector<float>& values,
                                                            double clip) {
  constexpr double support = 3;      // voxels; by hand: larger is smoother and takes more steps to solve
  constexpr double accuracy = 1e-5;  // relative residual; by hand
  typename LatticeField<Dim>::Data data;
  const Kernel kernel(data.kernel, Dim);
  const double edge = grid.spacing.template head<Dim>().minCoeff();
  const auto reach = static_cast<Index>(support);
  std::vector<ToeplitzTap<Dim>> taps;
  std::array<Index, Dim> k;
  k.fill(-reach);
  for (std::size_t a = 0; a < Dim;) {
    double r2 = 0;
    for (const Index offset : k) r2 += static_cast<double>(offset * offset);
    const double r = std::sqrt(r2) / support;
    if (r < 1) taps.push_back({k, kernel.value(r)});
    for (a = 0; a < Dim && ++k[a] > reach; ++a) k[a] = -reach;
  }
  std::copy_n(grid.size.begin(), Dim, data.size.begin());
  Eigen::VectorXd clipped(grid.voxels());
  for (Index i = 0; i < clipped.size(); ++i) clipped[i] = std::clamp(static_cast<double>(values[i]), -clip, clip);
  ToeplitzOptions options;
  options.tolerance = accuracy;
  const Eigen::VectorXd c = ToeplitzSystem<Dim>(data.size, taps, options).solve(clipped);
  data.coefficients.assign(c.begin(), c.end());
  data.support = support * edge;
  data.step.setConstant(edge);
  data.to_lattice = grid.to_voxel<Dim>();
  data.bounds = image_box<Dim>(grid);
  return std::make_shared<const LatticeField<Dim>>(std::move(data));
}

// Labels of the voxels that moved; returns how many changed.
template <int Dim>
Index relabel(const DenseLevelSet<Dim>& f, std::vector<unsigned char>& labels) {
  Index changed = 0;
  for (const Index i : f.active()) {
    const auto voxel = static_cast<std::size_t>(i);
    const unsigned char now = f.values()[voxel] > 0 ? 1 : 0;
    changed += now != labels[voxel] ? 1 : 0;
    labels[voxel] = now;
  }
  return changed;
}

}  // namespace

template <int Dim>
FiniteDifferenceResult<Dim> finite_difference(const Grid& grid, const unsigned char* start, const ForceUpdate& force,
                                              const FiniteDifferenceOptions& options) {
  check_finite_difference(grid, options, Dim);
  const double edge = grid.spacing.template head<Dim>().minCoeff();
  const auto n = static_cast<std::size_t>(grid.voxels());
  FiniteDifferenceResult<Dim> result;
  result.labels.resize(n);
  std::transform(start, start + n, result.labels.begin(), [](unsigned char l) -> unsigned char { return l != 0; });
  const auto inside = std::count(result.labels.begin(), result.labels.end(), 1);
  require(inside > 0 && inside < grid.voxels(), finite_difference_function, "voxels inside the start", inside,
          "must be some and not all of the image");
  const double band = options.band > 0 ? options.band * edge : std::numeric_limits<double>::infinity();
  DenseLevelSet<Dim> f(grid, signed_distance(grid, start), band);

  // Half a voxel per step: twice the band, and in the whole image far enough for the contour.
  const int steps = options.band > 0 ? static_cast<int>(2 * options.band) : 12;
  std::vector<float> forces(n), speed(n);
  std::vector<unsigned char> before = result.labels;
  DenseMotion motion{speed.data(), options.length * edge, options.penalty * edge};
  for (; result.iterations < options.iterations && !result.converged; ++result.iterations) {
    report(options.progress, "evolve",
           static_cast<double>(result.iterations) / static_cast<double>(options.iterations));
    force(result.labels.data(), forces.data());
    const double largest = speed_of(forces, speed);
    if (largest == 0 && motion.curvature == 0 && motion.penalty == 0) {
      result.converged = true;
      break;
    }
    f.step(motion, f.stable_step(largest, motion));
    if (options.reinitialize_every > 0 && (result.iterations + 1) % options.reinitialize_every == 0)
      f.reinitialize(steps, 1 + options.reinitialize_every / Dim);
    result.changes.push_back(relabel(f, result.labels));
    result.gaps.push_back(label_gap(result.labels, forces));
    if ((result.iterations + 1) % window != 0) continue;
    Index changed = 0;
    for (std::size_t i = 0; i < n; ++i) changed += before[i] != result.labels[i] ? 1 : 0;
    result.converged = static_cast<double>(changed) <= options.tolerance * static_cast<double>(n);
    before = result.labels;
  }
  result.values = f.values();
  constexpr double clip = 3;  // edges, as far as the support of the interpolant reaches; by hand
  result.field = interpolate_values<Dim>(grid, result.values, clip * edge);
  return result;
}

template FiniteDifferenceResult<2> finite_difference<2>(const Grid&, const unsigned char*, const ForceUpdate&,
                                                        const FiniteDifferenceOptions&);
template FiniteDifferenceResult<3> finite_difference<3>(const Grid&, const unsigned char*, const ForceUpdate&,
                                                        const FiniteDifferenceOptions&);

}  // namespace csrbf
