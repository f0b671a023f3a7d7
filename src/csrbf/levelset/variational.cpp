#include "csrbf/levelset/variational.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/parallel_sum.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/levelset/box_mean.hpp"
#include "csrbf/levelset/region_labels.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

constexpr int fit_steps = 6;      // of conjugate gradients: the noise of the voxels comes in with later ones
constexpr int descent_steps = 4;  // between two estimates of the statistics
constexpr double still = 3e-4;    // share of labels that may change at rest
constexpr double little = 0.05;   // share of the decrease so far below which a round is the last
constexpr double noisy = 0.01;    // above, a share of .01 of the energy is not worth a round, below it is one of .001
constexpr double clean = 0.002;   // noise below: voxels at the contour are as sure as all others
constexpr double side_margin = 0.02;  // that they then keep from the contour, in values of f
constexpr int side_steps = 12;        // and the steps to bring them there
constexpr double least_eps = 0.03;    // below, H is a step for any voxel
constexpr double noise_to_eps = 3;    // the contour averages voxels that noise alone could move across it

double mean_size(std::span<const float> force) {
  constexpr Index grain = 1 << 16;
  const auto n = static_cast<Index>(force.size());
  return parallel_sum(n, grain,
                      [&](Index begin, Index end) {
                        double sum = 0;
                        for (Index i = begin; i < end; ++i)
                          sum += static_cast<double>(std::abs(force[static_cast<std::size_t>(i)]));
                        return sum;
                      }) /
         static_cast<double>(n);
}

// What a voxel in the wrong region costs. Regions of one law cost nothing: then any scale will do.
double force_scale(std::span<const float> force) {
  constexpr double least = 1e-12;
  const double mean = mean_size(force);
  return mean > least ? mean : 1;
}

// Without noise each voxel at the contour may be obeyed; with it the mean of many must.
double choose_anchor(double noise) {
  return std::clamp(0.3 + 120 * noise, 0.3, 6.0);
}

// A length is measured well when the contour is three voxels wide where f is steepest.
template <int Dim>
double least_width(const Lattice<Dim>& lattice, const ContourEnergy& energy) {
  return energy.length > 0 ? 1.5 * lattice.steepest() * lattice.spacing().template head<Dim>().minCoeff() : 0;
}

// One level set of a segmentation and its energy.
template <int Dim>
struct LevelSet {
  std::vector<float> force;
  std::vector<float> coefficients;
  ContourEnergy energy;
  double others = 0;  // what the voxels cost outside

  LevelSet(const Lattice<Dim>& lattice, Index voxels, double length, double noise)
      : force(static_cast<std::size_t>(voxels)),
        coefficients(static_cast<std::size_t>(lattice.array_size()), 0.0F),
        energy{force.data(), length, 1, choose_anchor(noise)} {}
  [[nodiscard]] double total(const Lattice<Dim>& lattice) const {
    return others + contour_energy(lattice, energy, coefficients.data(), nullptr);
  }
};

// The region whose level set is largest; for one level set 1 inside and 0 outside.
template <int Dim>
Index label_voxels(const Lattice<Dim>& lattice, const std::vector<LevelSet<Dim>>& sets,
                   std::vector<std::uint8_t>& labels) {
  if (sets.size() == 1) return update_labels(lattice, sets[0].coefficients, labels.data());
  std::vector<float> best(labels.size(), -std::numeric_limits<float>::infinity());
  const std::vector<std::uint8_t> before = labels;
  for (std::size_t k = 0; k < sets.size(); ++k)
    lattice.sweep(
        sets[k].coefficients.data(), false,
        [&](const LatticeRow& row) {
          for (Index i = 0; i < row.count; ++i) {
            const auto voxel = static_cast<std::size_t>(row.voxel + i * row.stride);
            if (row.value[i] <= best[voxel]) continue;
            best[voxel] = row.value[i];
            labels[voxel] = static_cast<std::uint8_t>(k);
          }
          return 0.0;
        },
        nullptr);
  Index changed = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) changed += labels[i] != before[i] ? 1 : 0;
  return changed;
}

}  // namespace

double ForceSource::force_with_prior(int k, double scale, std::span<float> to) const {
  const double others = force(k, scale, to) / scale;
  for (std::size_t i = 0; i < prior.size(); ++i) to[i] += prior[i];
  return others;
}

ForceNoise force_noise(std::span<const float> force, std::span<const std::uint8_t> labels,
                       std::span<const std::uint8_t> mask, const Grid& grid) {
  constexpr std::size_t enough = 50000, far = 3;
  const auto takes_part = [&](std::size_t i) { return mask.empty() || mask[i] != 0; };
  // What is clear in a voxel already counts no more than that, as in the targets of the level set.
  const auto clear = static_cast<float>(2 * mean_size(force));
  const auto at = [&](std::size_t i) { return static_cast<double>(std::clamp(force[i], -clear, clear)); };
  std::array<double, 2> sums{0, 0}, counts{0, 0};
  std::array<std::vector<double>, 2> bends;  // second differences of neighbours, and of voxels three apart in a region
  const std::size_t step = std::max<std::size_t>(1, force.size() / enough) | 1;
  const auto nx = static_cast<std::size_t>(grid.size[0]);
  for (std::size_t i = 0; i < force.size(); i += step) {
    if (!takes_part(i)) continue;
    const std::size_t k = labels[i] != 0 ? 1 : 0;
    sums[k] += at(i);
    counts[k] += 1;
    const std::size_t x = i % nx;
    if (x == 0 || x + 1 >= nx || !takes_part(i - 1) || !takes_part(i + 1)) continue;
    bends[0].push_back(std::abs(at(i - 1) - 2 * at(i) + at(i + 1)));
    if (x < 2 * far || x + 2 * far >= nx) continue;
    bool inside = true;
    for (std::size_t j = i - 2 * far; j <= i + 2 * far; ++j) inside = inside && labels[j] == labels[i] && takes_part(j);
    if (inside) bends[1].push_back(std::abs(at(i - far) - 2 * at(i) + at(i + far)));
  }
  const double gap = sums[0] / std::max(counts[0], 1.0) - sums[1] / std::max(counts[1], 1.0);
  if (bends[0].empty()) return {};
  const auto deviation = [](std::vector<double>& values) {
    return median(values) / (median_of_normal * std::sqrt(6.0));
  };
  constexpr std::size_t few = 200;
  const double near = deviation(bends[0]);
  if (!(gap > 0)) return {near > 0 ? 1.0 : 0.0, 1};
  if (bends[1].size() < few) return {near / gap, 1};
  const double apart = deviation(bends[1]);
  return {std::max(near, apart) / gap, near > 0 ? std::clamp(std::sqrt(apart / near), 1.0, 3.0) : 1};
}

double choose_center_spacing(const ForceNoise& noise, int dimension) {
  // Measured: 2 voxels are best for a noise of 2 % of the contrast, 4 for 15 %; in a volume more voxels share a center.
  const double spacing = 2 * noise.grain * std::cbrt(noise.size / 0.02) * (dimension == 3 ? 0.75 : 1.0);
  return std::round(std::clamp(spacing, 2.0, 12.0));
}

template <int Dim>
VariationalResult descend_globally(const Lattice<Dim>& lattice, const ForceSource& source,
                                   const SegmentOptions& options, double noise, std::vector<std::uint8_t> labels) {
  VariationalResult result;
  SegmentReport& report = result.report;
  const auto voxels = static_cast<Index>(labels.size());
  const bool two = source.regions == 2;
  std::vector<LevelSet<Dim>> sets;
  for (int k = two ? 1 : 0; k < source.regions; ++k)
    sets.emplace_back(lattice, voxels, options.smoothness.value_or(0), noise);
  source.force(two ? 1 : 0, 1, sets[0].force);
  const double scale = force_scale(sets[0].force);
  const auto take_forces = [&] {
    for (std::size_t i = 0; i < sets.size(); ++i)
      sets[i].others = source.force_with_prior(two ? 1 : static_cast<int>(i), scale, sets[i].force);
  };
  take_forces();
  for (LevelSet<Dim>& set : sets) {
    fit_target(lattice, set.energy, fit_steps, set.coefficients);
    constexpr double clear = 0.3;  // level from which a voxel is clearly in or out
    set.energy.eps = std::max(least_eps, noise_to_eps * target_residual(lattice, set.energy, set.coefficients, clear));
  }
  label_voxels(lattice, sets, labels);
  const auto total = [&] {
    double sum = 0;
    for (const LevelSet<Dim>& set : sets) sum += set.total(lattice);
    return sum;
  };

  double energy = total();
  report.energy.push_back(energy / static_cast<double>(voxels));
  while (report.iterations < options.iterations && !report.converged) {
    csrbf::report(options.progress, "evolve", static_cast<double>(report.iterations) / options.iterations);
    ++report.iterations;
    const double energy_before = report.energy.back();
    // New statistics, if they are better for the contours as they are.
    if ((report.iterations > 1 || !two) && source.fit(labels)) {
      take_forces();
      const double next = total();
      if (next <= energy) {
        energy = next;
      } else {
        source.undo();
        take_forces();
      }
    }
    std::vector<std::vector<double>> steps(sets.size());
    for (std::size_t i = 0; i < sets.size(); ++i) {
      evolve(lattice, sets[i].energy, descent_steps, 1e-3, sets[i].coefficients, steps[i]);
      for (std::size_t j = 1; j < steps[i].size(); ++j) {
        energy += steps[i][j] - steps[i][j - 1];
        report.energy.push_back(energy / static_cast<double>(voxels));
      }
    }
    const Index changed = label_voxels(lattice, sets, labels);
    const double first = report.energy.front(), last = report.energy.back();
    const double hardly = noise > noisy ? 0.01 : 0.001;
    report.converged =
        static_cast<double>(changed) <= (noise > noisy ? still : 0.1 * still) * static_cast<double>(voxels) ||
        energy_before - last <= std::max(little * (first - last), hardly * std::abs(last));
  }
  // Without noise the contour needs no anchor any more: each voxel goes to its side, if the rest of the energy allows.
  if (two && noise < clean && sets[0].energy.length == 0) {
    const std::vector<float> before = sets[0].coefficients;
    sets[0].energy.anchor = 0;
    separate_voxels(lattice, sets[0].force.data(), side_margin, side_steps, sets[0].coefficients);
    const double next = total();
    if (next <= energy) {
      report.energy.push_back(next / static_cast<double>(voxels));
      label_voxels(lattice, sets, labels);
    } else {
      sets[0].coefficients = before;
    }
  }
  for (LevelSet<Dim>& set : sets) result.coefficients.push_back(std::move(set.coefficients));
  result.labels = std::move(labels);
  return result;
}

namespace {

// 1 in voxels at most `width` away (along the axes) from one whose label differs from that of a neighbour, else 0.
std::vector<float> band_of(const std::vector<std::uint8_t>& labels, const Grid& grid, Index width) {
  const Index nx = grid.size[0], ny = grid.size[1], nz = grid.size[2];
  std::vector<float> band(labels.size(), 0.0F);
  const std::array<Index, 3> strides{1, nx, nx * ny};
  parallel_for(ny * nz, 16, [&](Index begin, Index end) {
    for (Index row = begin; row < end; ++row)
      for (Index x = 0; x < nx; ++x) {
        const std::array<Index, 3> at{x, row % ny, row / ny};
        const Index i = x + nx * row;
        const std::uint8_t label = labels[static_cast<std::size_t>(i)];
        bool edge = false;
        for (std::size_t a = 0; a < 3; ++a) {
          if (at[a] > 0) edge |= labels[static_cast<std::size_t>(i - strides[a])] != label;
          if (at[a] + 1 < grid.size[a]) edge |= labels[static_cast<std::size_t>(i + strides[a])] != label;
        }
        if (edge) band[static_cast<std::size_t>(i)] = 1;
      }
  });
  std::array<Index, 3> widths{width, width, width};
  for (std::size_t a = 0; a < 3; ++a) widths[a] = grid.size[a] > 1 ? width : 0;
  box_mean(band, grid.size, widths);
  for (float& value : band) value = value > 0 ? 1.0F : 0.0F;
  return band;
}

}  // namespace

template <int Dim>
VariationalResult descend_locally(const Lattice<Dim>& lattice, const ForceSource& source, const SegmentOptions& options,
                                  const Grid& grid, double noise, std::vector<std::uint8_t> labels) {
  constexpr Index reach = 2;  // voxels that the contour may move in a step
  constexpr int first_fit = 12, fit = 3, descent = 3;
  VariationalResult result;
  SegmentReport& report = result.report;
  const auto voxels = static_cast<Index>(labels.size());
  LevelSet<Dim> set(lattice, voxels, options.smoothness.value_or(0), noise);
  std::vector<float> held(labels.size());
  const auto hold = [&] {  // every voxel where it is
    for (std::size_t i = 0; i < labels.size(); ++i) held[i] = labels[i] != 0 ? -1.0F : 1.0F;
  };
  const auto free_band = [&] {  // but for those at the contour
    hold();
    const std::vector<float> band = band_of(labels, grid, reach);
    for (std::size_t i = 0; i < held.size(); ++i)
      if (band[i] > 0) held[i] = set.force[i];
  };
  ContourEnergy step = set.energy;
  step.force = held.data();
  hold();
  fit_target(lattice, step, first_fit, set.coefficients);

  source.fit(labels);
  source.force(1, 1, set.force);
  const double scale = force_scale(set.force);
  set.others = source.force_with_prior(1, scale, set.force);
  set.energy.eps = step.eps = std::max({0.1, noise_to_eps * noise, least_width(lattice, set.energy)});
  double energy = set.total(lattice);
  report.energy.push_back(energy / static_cast<double>(voxels));
  const int most = 10 * options.iterations;  // steps are small
  while (report.iterations < most && !report.converged) {
    csrbf::report(options.progress, "evolve", static_cast<double>(report.iterations) / most);
    ++report.iterations;
    free_band();
    const std::vector<float> before = set.coefficients;
    fit_target(lattice, step, fit, set.coefficients);
    std::vector<double> steps;
    evolve(lattice, step, descent, 1e-3, set.coefficients, steps);
    const double next = set.total(lattice);
    if (next > energy) {
      set.coefficients = before;
      report.converged = true;
      break;
    }
    energy = next;
    const Index changed = update_labels(lattice, set.coefficients, labels.data());
    report.converged = static_cast<double>(changed) <= 0.1 * still * static_cast<double>(voxels);
    if (source.fit(labels)) {
      set.others = source.force_with_prior(1, scale, set.force);
      const double updated = set.total(lattice);
      if (updated <= energy) {
        energy = updated;
      } else {
        source.undo();
        set.others = source.force_with_prior(1, scale, set.force);
      }
    }
    report.energy.push_back(energy / static_cast<double>(voxels));
  }
  update_labels(lattice, set.coefficients, labels.data());
  if (options.fill_holes.value_or(false) && fill_enclosed(labels, grid) > 0) {
    free_band();
    fit_target(lattice, step, first_fit, set.coefficients);
    update_labels(lattice, set.coefficients, labels.data());
    fill_enclosed(labels, grid);
  }
  result.coefficients.push_back(std::move(set.coefficients));
  result.labels = std::move(labels);
  return result;
}

#define CSRBF_INSTANTIATE(Dim)                                                                                     \
  template VariationalResult descend_globally<Dim>(const Lattice<Dim>&, const ForceSource&, const SegmentOptions&, \
                                                   double, std::vector<std::uint8_t>);                             \
  template VariationalResult descend_locally<Dim>(const Lattice<Dim>&, const ForceSource&, const SegmentOptions&,  \
                                                  const Grid&, double, std::vector<std::uint8_t>);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
