#include "csrbf/levelset/contour/edge_flow.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/levelset/image/box_mean.hpp"
#include "csrbf/levelset/regions/region_labels.hpp"

#include <utility>

namespace csrbf {
namespace {

constexpr float band = 3;            // half width in voxels within which f is a distance; constant beyond. By hand
constexpr double time_step = 0.5;    // in voxels for speed 1: below the limit of the Laplacian in 3D
constexpr int first_fit = 12;        // steps of conjugate gradients to the labels given,
constexpr int flow_fit_steps = 3;    // and after each step of time, which changes the target little; both by hand
constexpr int patience = 20;         // steps without a lower energy, ten voxels of motion at most; by hand
constexpr double noticeable = 1e-4;  // relative decrease that resets the patience; by hand
constexpr std::size_t steep_voxels = 100;  // one voxel in so many has at least the gradient of a clear edge,
constexpr float edge_share = 0.25F;        // of which this share halves the weight; both by hand
constexpr float flat_from = 0.9F;          // |f| of the fit, whose target is at most 1, beyond the band

std::array<Index, 3> unit_box(const Grid& grid) {
  std::array<Index, 3> width{0, 0, 0};
  for (Index a = 0; a < 3; ++a) width[a] = grid.size[a] > 1 ? 1 : 0;
  return width;
}

// Central differences of values by the physical coordinates in units of the shortest edge, one array per axis.
template <int Dim>
std::array<std::vector<float>, Dim> slopes_of(std::span<const float> values, const Grid& grid, double unit) {
  std::array<std::vector<float>, Dim> slopes;
  const Index nx = grid.size[0], ny = grid.size[1], nz = grid.size[2];
  const std::array<Index, 3> strides{1, nx, nx * ny};
  for (Index a = 0; a < Dim; ++a) {
    slopes[a].resize(values.size());
    const double step = grid.spacing[a] / unit;
    parallel_for(ny * nz, 16, [&, a](Index begin, Index end) {
      for (Index row = begin; row < end; ++row)
        for (Index x = 0; x < nx; ++x) {
          const Index at = a == 0 ? x : a == 1 ? row % ny : row / ny, i = x + nx * row;
          const Index lo = at > 0 ? strides[a] : 0, hi = at + 1 < grid.size[a] ? strides[a] : 0;
          const double steps = lo > 0 && hi > 0 ? 2 : 1;
          slopes[a][i] = static_cast<float>(static_cast<double>(values[i + hi] - values[i - lo]) / (steps * step));
        }
    });
  }
  return slopes;
}

// A level set that moves to edges.
template <int Dim>
class EdgeFlow {
 public:
  EdgeFlow(const Lattice<Dim>& lattice, const EdgeFlowOptions& options, const Grid& grid, std::span<const float> g,
           std::vector<std::uint8_t> labels)
      : lattice_(lattice),
        options_(options),
        grid_(grid),
        g_(g),
        unit_(grid.spacing.template head<Dim>().minCoeff()),
        smoothness_(static_cast<float>(options.smoothness)),
        slopes_(slopes_of<Dim>(g, grid, unit_)),
        coefficients_(static_cast<std::size_t>(lattice.array_size()), 0.0F),
        distance_(labels.size()),
        speed_(labels.size()),
        force_(labels.size()),
        pressure_(labels.size()) {
    result_.labels = std::move(labels);
  }

  VariationalResult run() {
    start();
    std::vector<float> best;
    double least = std::numeric_limits<double>::infinity();
    int since = 0;
    const int most = 10 * options_.iterations;
    for (; result_.iterations < most && since < patience; ++result_.iterations) {
      report(options_.progress, "evolve", static_cast<double>(result_.iterations) / most);
      move_contour();
      const double energy = this->energy();
      ++since;
      if (energy < least) {
        if (!(energy > least - noticeable * std::abs(least))) since = 0;
        least = energy;
        best = coefficients_;
        result_.energy.push_back(energy);
      }
    }
    result_.converged = since >= patience;
    update_labels(lattice_, best, result_.labels.data());
    if (options_.fill_holes) fill_enclosed(result_.labels, grid_, options_.seeds);
    result_.coefficients.push_back(std::move(best));
    return std::move(result_);
  }

 private:
  void start() {
    const auto balloon = static_cast<float>(options_.balloon);
    for (std::size_t i = 0; i < force_.size(); ++i) {
      force_[i] = result_.labels[i] != 0 ? -2.0F : 2.0F;
      pressure_[i] = options_.mask.empty() || options_.mask[i] != 0 ? -balloon * g_[i] : 1.0F;
    }
    fit_target(lattice_, target(), first_fit, coefficients_);
  }

  [[nodiscard]] ContourEnergy target() const { return {force_.data(), 0, 1, 1}; }

  // smoothness int g - balloon int_inside g, per voxel.
  [[nodiscard]] double energy() const {
    const ContourEnergy geodesic{pressure_.data(), static_cast<double>(smoothness_), 0.5, 0, g_.data()};
    return contour_energy(lattice_, geodesic, coefficients_.data(), nullptr) / static_cast<double>(force_.size());
  }

  // Distances and the speeds of advection and pressure from the level set.
  void read(const LatticeRow& row) {
    for (Index i = 0; i < row.count; ++i) {
      const auto voxel = static_cast<std::size_t>(row.voxel + i * row.stride);
      float norm2 = 1e-12F, along = 0;
      for (Index a = 0; a < Dim; ++a) {
        const float d = row.gradient[a][i] * static_cast<float>(unit_);
        norm2 += d * d;
        along += d * slopes_[a][voxel];
      }
      const float norm = std::sqrt(norm2);
      distance_[voxel] = std::clamp(row.value[i] / norm, -band, band);
      // Where f is flat, far from the contour, only its sign is known.
      if (std::abs(row.value[i]) > flat_from) distance_[voxel] = row.value[i] > 0 ? band : -band;
      speed_[voxel] = smoothness_ * along / norm - pressure_[voxel];
    }
  }

  void move_contour() {
    lattice_.sweep(
        coefficients_.data(), true,
        [&](const LatticeRow& row) {
          read(row);
          return 0.0;
        },
        nullptr);
    mean_ = distance_;
    box_mean(mean_, grid_.size, unit_box(grid_));
    parallel_for(std::ssize(force_), 1 << 14, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        float d = distance_[i];
        // The mean over a box of three voxels is f + Laplacian f / 3.
        if (std::abs(d) < band)
          d += static_cast<float>(time_step) * (speed_[i] + smoothness_ * g_[i] * 3 * (mean_[i] - d));
        force_[i] = -2 * std::clamp(d / band, -1.0F, 1.0F);
      }
    });
    fit_target(lattice_, target(), flow_fit_steps, coefficients_);
  }

  const Lattice<Dim>& lattice_;
  const EdgeFlowOptions& options_;
  const Grid& grid_;
  std::span<const float> g_;
  double unit_;
  float smoothness_;
  std::array<std::vector<float>, Dim> slopes_;  // of g
  VariationalResult result_;
  std::vector<float> coefficients_;
  std::vector<float> distance_, speed_, force_, pressure_, mean_;
};

}  // namespace

std::vector<float> edge_weights(std::span<const float> values, const Grid& grid) {
  std::vector<float> smooth(values.begin(), values.end());
  box_mean(smooth, grid.size, unit_box(grid));
  box_mean(smooth, grid.size, unit_box(grid));
  double unit = grid.spacing[0];
  for (int a = 1; a < grid.dimension(); ++a) unit = std::min(unit, grid.spacing[a]);
  const auto slopes = slopes_of<3>(smooth, grid, unit);
  std::vector<float>& weights = smooth;
  for (std::size_t i = 0; i < weights.size(); ++i)
    weights[i] = std::sqrt(slopes[0][i] * slopes[0][i] + slopes[1][i] * slopes[1][i] + slopes[2][i] * slopes[2][i]);
  std::vector<float> sorted = weights;
  const float steep =
      order_statistic(sorted, static_cast<std::ptrdiff_t>(sorted.size() - 1 - sorted.size() / steep_voxels));
  const float k = std::max(edge_share * steep, std::numeric_limits<float>::min());
  for (float& weight : weights) weight = 1 / (1 + (weight / k) * (weight / k));
  return weights;
}

template <int Dim>
VariationalResult descend_to_edges(const Lattice<Dim>& lattice, const EdgeFlowOptions& options, const Grid& grid,
                                   std::span<const float> g, std::vector<std::uint8_t> labels) {
  return EdgeFlow<Dim>(lattice, options, grid, g, std::move(labels)).run();
}

template VariationalResult descend_to_edges<2>(const Lattice<2>&, const EdgeFlowOptions&, const Grid&,
                                               std::span<const float>, std::vector<std::uint8_t>);
template VariationalResult descend_to_edges<3>(const Lattice<3>&, const EdgeFlowOptions&, const Grid&,
                                               std::span<const float>, std::vector<std::uint8_t>);

}  // namespace csrbf
