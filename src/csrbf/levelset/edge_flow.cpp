#include "csrbf/levelset/edge_flow.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/levelset/box_mean.hpp"
#include "csrbf/levelset/region_labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace csrbf {
namespace {

constexpr float band = 3;  // half width in voxels within which f is a distance; then it is constant

std::array<Index, 3> unit_box(const Grid& grid) {
  std::array<Index, 3> width{0, 0, 0};
  for (std::size_t a = 0; a < 3; ++a) width[a] = grid.size[a] > 1 ? 1 : 0;
  return width;
}

// Central differences of values by the physical coordinates in units of the shortest edge, one array per axis.
template <int Dim>
std::array<std::vector<float>, Dim> slopes_of(std::span<const float> values, const Grid& grid, double unit) {
  std::array<std::vector<float>, Dim> slopes;
  const Index nx = grid.size[0], ny = grid.size[1], nz = grid.size[2];
  const std::array<Index, 3> strides{1, nx, nx * ny};
  for (std::size_t a = 0; a < Dim; ++a) {
    slopes[a].resize(values.size());
    const double step = grid.spacing[static_cast<Index>(a)] / unit;
    parallel_for(ny * nz, 16, [&, a](Index begin, Index end) {
      for (Index row = begin; row < end; ++row)
        for (Index x = 0; x < nx; ++x) {
          const Index at = a == 0 ? x : a == 1 ? row % ny : row / ny, i = x + nx * row;
          const Index lo = at > 0 ? strides[a] : 0, hi = at + 1 < grid.size[a] ? strides[a] : 0;
          const double steps = lo > 0 && hi > 0 ? 2 : 1;
          slopes[a][static_cast<std::size_t>(i)] = static_cast<float>(
              static_cast<double>(values[static_cast<std::size_t>(i + hi)] - values[static_cast<std::size_t>(i - lo)]) /
              (steps * step));
        }
    });
  }
  return slopes;
}

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
  const float steep = order_statistic(sorted, static_cast<std::ptrdiff_t>(sorted.size() - 1 - sorted.size() / 100));
  const float k = std::max(0.25F * steep, std::numeric_limits<float>::min());
  for (float& weight : weights) weight = 1 / (1 + (weight / k) * (weight / k));
  return weights;
}

template <int Dim>
VariationalResult descend_to_edges(const Lattice<Dim>& lattice, const SegmentOptions& options, const Grid& grid,
                                   std::span<const float> g, std::vector<std::uint8_t> labels) {
  constexpr double step = 0.5;         // of time, in voxels for speed 1: below the limit of the Laplacian in 3D
  constexpr int patience = 20;         // steps without a lower energy
  constexpr double noticeable = 1e-4;  // relative decrease
  const double unit = grid.spacing.template head<Dim>().minCoeff();
  const auto smoothness = static_cast<float>(options.smoothness.value_or(1));
  const auto balloon = static_cast<float>(options.balloon);
  const std::size_t n = labels.size();
  const auto slopes = slopes_of<Dim>(g, grid, unit);

  VariationalResult result;
  SegmentReport& report = result.report;
  std::vector<float> coefficients(static_cast<std::size_t>(lattice.array_size()), 0.0F), best;
  std::vector<float> distance(n), speed(n), force(n), pressure(n);
  for (std::size_t i = 0; i < n; ++i) {
    force[i] = labels[i] != 0 ? -2.0F : 2.0F;
    pressure[i] = options.mask.empty() || options.mask[i] != 0 ? -balloon * g[i] : 1.0F;
  }
  const ContourEnergy target{force.data(), 0, 1, 1};
  const ContourEnergy geodesic{pressure.data(), static_cast<double>(smoothness), 0.5, 0, g.data()};
  fit_target(lattice, target, 12, coefficients);

  // Distances and the speeds of advection and pressure from the level set.
  const auto read = [&](const LatticeRow& row) {
    for (Index i = 0; i < row.count; ++i) {
      const auto voxel = static_cast<std::size_t>(row.voxel + i * row.stride);
      float norm2 = 1e-12F, along = 0;
      for (std::size_t a = 0; a < Dim; ++a) {
        const float d = row.gradient[a][i] * static_cast<float>(unit);
        norm2 += d * d;
        along += d * slopes[a][voxel];
      }
      const float norm = std::sqrt(norm2);
      distance[voxel] = std::clamp(row.value[i] / norm, -band, band);
      // Where f is flat, far from the contour, only its sign is known.
      if (std::abs(row.value[i]) > 0.9F) distance[voxel] = row.value[i] > 0 ? band : -band;
      speed[voxel] = smoothness * along / norm - pressure[voxel];
    }
    return 0.0;
  };
  int since = 0;
  const int most = 10 * options.iterations;
  double least = std::numeric_limits<double>::infinity();
  std::vector<float> mean;
  for (; report.iterations < most && since < patience; ++report.iterations) {
    csrbf::report(options.progress, "evolve", static_cast<double>(report.iterations) / most);
    lattice.sweep(coefficients.data(), true, read, nullptr);
    mean = distance;
    box_mean(mean, grid.size, unit_box(grid));
    parallel_for(static_cast<Index>(n), 1 << 14, [&](Index begin, Index end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
        float d = distance[i];
        // The mean over a box of three voxels is f + Laplacian f / 3.
        if (std::abs(d) < band) d += static_cast<float>(step) * (speed[i] + smoothness * g[i] * 3 * (mean[i] - d));
        force[i] = -2 * std::clamp(d / band, -1.0F, 1.0F);
      }
    });
    fit_target(lattice, target, 3, coefficients);
    const double energy = contour_energy(lattice, geodesic, coefficients.data(), nullptr) / static_cast<double>(n);
    ++since;
    if (energy < least) {
      if (!(energy > least - noticeable * std::abs(least))) since = 0;
      least = energy;
      best = coefficients;
      report.energy.push_back(energy);
    }
  }
  report.converged = since >= patience;
  update_labels(lattice, best, labels.data());
  if (options.fill_holes.value_or(false)) fill_enclosed(labels, grid);
  result.coefficients.push_back(std::move(best));
  result.labels = std::move(labels);
  return result;
}

template VariationalResult descend_to_edges<2>(const Lattice<2>&, const SegmentOptions&, const Grid&,
                                               std::span<const float>, std::vector<std::uint8_t>);
template VariationalResult descend_to_edges<3>(const Lattice<3>&, const SegmentOptions&, const Grid&,
                                               std::span<const float>, std::vector<std::uint8_t>);

}  // namespace csrbf
