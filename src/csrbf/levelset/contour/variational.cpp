#include "csrbf/levelset/contour/variational.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/levelset/image/box_mean.hpp"
#include "csrbf/levelset/regions/force_noise.hpp"
#include "csrbf/levelset/regions/region_labels.hpp"

#include <utility>

namespace csrbf {
namespace {

constexpr int fit_steps = 6;      // of conjugate gradients: the noise of the voxels comes in with later ones
constexpr int descent_steps = 4;  // between two estimates of the statistics; by hand: more follow old statistics longer
constexpr double descent_tolerance = 1e-3;  // share of the decrease so far below which a descent ends; by hand
constexpr double changed_share = 3e-4;      // of the labels may change at convergence; by hand: larger ends earlier
constexpr double least_progress = 0.05;     // share of the decrease so far below which a round is the last; by hand
constexpr double noisy_from = 0.01;    // noise above: a share of .01 of the energy is not worth a round, below: of .001
constexpr double clean_below = 0.002;  // noise below: voxels at the contour are as sure as all others
constexpr double side_margin = 0.02;   // that they then keep from the contour, in values of f; by hand
constexpr int side_steps = 12;         // and the steps to bring them there; by hand: more cost time for the last voxels
constexpr double least_eps = 0.03;     // below, H is a step for any voxel
constexpr double noise_to_eps = 3;     // the contour averages voxels that noise alone could move across it

// Of local descent, all by hand: the contour may move `local_reach` voxels in a step, with these steps of conjugate
// gradients at the start and at the end, and in each step these of conjugate gradients and of descent. More are closer
// to the minimum within the band, which moves on anyway.
constexpr Index local_reach = 2;
constexpr int local_first_fit = 12, local_fit = 3, local_descent = 3;
constexpr double local_least_eps = 0.1;  // so that H reaches the voxels next to the contour
constexpr float masked_force = 1;        // that of a voxel that is clearly outside

// The mean cost of a voxel in the wrong region. It is 0 for regions of one law: then any scale will do.
double force_scale(std::span<const float> force) {
  constexpr double least = 1e-12;  // in units of the range of intensities, or its square: rounding
  const double mean = mean_magnitude(force);
  return mean > least ? mean : 1;
}

// Without noise the contour may follow each voxel, with noise only the mean of many. By hand: a larger anchor keeps f
// closer to the least-squares fit.
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
  const std::vector<std::uint8_t> before = labels;
  std::vector<const float*> coefficients;
  for (const LevelSet<Dim>& set : sets) coefficients.push_back(set.coefficients.data());
  update_labels(lattice, coefficients, labels);
  Index changed = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) changed += labels[i] != before[i] ? 1 : 0;
  return changed;
}

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
        const std::uint8_t label = labels[i];
        bool edge = false;
        for (std::size_t a = 0; a < 3; ++a) {
          if (at[a] > 0) edge |= labels[i - strides[a]] != label;
          if (at[a] + 1 < grid.size[a]) edge |= labels[i + strides[a]] != label;
        }
        if (edge) band[i] = 1;
      }
  });
  std::array<Index, 3> widths{width, width, width};
  for (std::size_t a = 0; a < 3; ++a) widths[a] = grid.size[a] > 1 ? width : 0;
  box_mean(band, grid.size, widths);
  for (float& value : band) value = value > 0 ? 1.0F : 0.0F;
  return band;
}

// Alternates between statistics and contours over the whole image.
template <int Dim>
class GlobalDescent {
 public:
  GlobalDescent(const Lattice<Dim>& lattice, ForceSource& source, const VariationalOptions& options,
                std::vector<std::uint8_t> labels)
      : lattice_(lattice), source_(source), options_(options), voxels_(std::ssize(labels)) {
    result_.labels = std::move(labels);
  }

  VariationalResult run() {
    start();
    while (result_.iterations < options_.iterations && !result_.converged) {
      report(options_.progress, "evolve", static_cast<double>(result_.iterations) / options_.iterations);
      ++result_.iterations;
      const double before = result_.energy.back();
      if (result_.iterations > 1 || !two()) update_statistics();
      move_contours();
      const Index changed = label_voxels(lattice_, sets_, result_.labels);
      result_.converged = is_at_rest(changed, before);
    }
    if (two() && options_.noise < clean_below && sets_[0].energy.length == 0) sharpen_contour();
    for (LevelSet<Dim>& set : sets_) result_.coefficients.push_back(std::move(set.coefficients));
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool two() const { return source_.regions() == 2; }

  // The level sets of the statistics of the labels given.
  void start() {
    for (int k = two() ? 1 : 0; k < source_.regions(); ++k)
      sets_.emplace_back(lattice_, voxels_, options_.smoothness, options_.noise);
    source_.force(two() ? 1 : 0, 1, sets_[0].force);
    scale_ = force_scale(sets_[0].force);
    take_forces();
    for (LevelSet<Dim>& set : sets_) {
      fit_target(lattice_, set.energy, fit_steps, set.coefficients);
      constexpr double clear = 0.3;  // |f| from which a voxel is clearly in or out; by hand
      const double residual = target_residual(lattice_, set.energy, set.coefficients, clear);
      set.energy.eps = std::max(least_eps, noise_to_eps * residual);
    }
    label_voxels(lattice_, sets_, result_.labels);
    energy_ = total();
    add_energy(energy_);
  }

  void take_forces() {
    for (std::size_t i = 0; i < sets_.size(); ++i)
      sets_[i].others = source_.force_with_prior(two() ? 1 : static_cast<int>(i), scale_, sets_[i].force);
  }

  [[nodiscard]] double total() const {
    double sum = 0;
    for (const LevelSet<Dim>& set : sets_) sum += set.total(lattice_);
    return sum;
  }

  void add_energy(double energy) { result_.energy.push_back(energy / static_cast<double>(voxels_)); }

  // New statistics, if they are better for the contours as they are.
  void update_statistics() {
    source_.fit(result_.labels);
    take_forces();
    const double next = total();
    if (next <= energy_) {
      energy_ = next;
      return;
    }
    source_.undo();
    take_forces();
  }

  void move_contours() {
    for (LevelSet<Dim>& set : sets_) {
      std::vector<double> steps;
      minimize_contour_energy(lattice_, set.energy, descent_steps, descent_tolerance, set.coefficients, steps);
      for (std::size_t j = 1; j < steps.size(); ++j) {
        energy_ += steps[j] - steps[j - 1];
        add_energy(energy_);
      }
    }
  }

  [[nodiscard]] bool is_at_rest(Index changed, double energy_before) const {
    const bool noise_counts = options_.noise > noisy_from;
    const double first = result_.energy.front(), last = result_.energy.back();
    const double negligible = noise_counts ? 0.01 : 0.001;  // of the energy; see noisy_from
    return static_cast<double>(changed) <=
               (noise_counts ? changed_share : 0.1 * changed_share) * static_cast<double>(voxels_) ||
           energy_before - last <= std::max(least_progress * (first - last), negligible * std::abs(last));
  }

  // Without noise the contour needs no anchor any more: each voxel goes to its side, if the rest of the energy allows.
  void sharpen_contour() {
    LevelSet<Dim>& set = sets_[0];
    const std::vector<float> before = set.coefficients;
    set.energy.anchor = 0;
    separate_voxels(lattice_, set.force.data(), side_margin, side_steps, set.coefficients);
    const double next = total();
    if (next <= energy_) {
      add_energy(next);
      label_voxels(lattice_, sets_, result_.labels);
    } else {
      set.coefficients = before;
    }
  }

  const Lattice<Dim>& lattice_;
  ForceSource& source_;
  const VariationalOptions& options_;
  Index voxels_;
  VariationalResult result_;
  std::vector<LevelSet<Dim>> sets_;
  double scale_ = 1, energy_ = 0;
};

// The contour moves with the voxels next to it; all others are held where they are.
template <int Dim>
class LocalDescent {
 public:
  LocalDescent(const Lattice<Dim>& lattice, ForceSource& source, const VariationalOptions& options, const Grid& grid,
               std::vector<std::uint8_t> labels)
      : lattice_(lattice),
        source_(source),
        options_(options),
        grid_(grid),
        set_(lattice, std::ssize(labels), options.smoothness, options.noise),
        held_(labels.size()),
        step_(set_.energy) {
    step_.force = held_.data();
    result_.labels = std::move(labels);
    leave_masked(result_.labels, std::uint8_t{0});
  }

  VariationalResult run() {
    start();
    const int most = 10 * options_.iterations;  // steps are small
    while (result_.iterations < most && !result_.converged) {
      report(options_.progress, "evolve", static_cast<double>(result_.iterations) / most);
      ++result_.iterations;
      if (!move_contour()) break;
      update_statistics();
      add_energy();
    }
    update_labels(lattice_, set_.coefficients, result_.labels.data());
    if (options_.fill_holes) fill_holes();
    result_.coefficients.push_back(std::move(set_.coefficients));
    return std::move(result_);
  }

 private:
  static Index inside(const std::vector<std::uint8_t>& labels) {
    return std::count_if(labels.begin(), labels.end(), [](std::uint8_t label) { return label != 0; });
  }

  template <class T>
  void leave_masked(std::vector<T>& values, T outside) const {
    for (std::size_t i = 0; i < options_.mask.size(); ++i)
      if (options_.mask[i] == 0) values[i] = outside;
  }

  void hold_voxels() {
    for (std::size_t i = 0; i < held_.size(); ++i) held_[i] = result_.labels[i] != 0 ? -1.0F : 1.0F;
  }

  void hold_all_but_band() {
    hold_voxels();
    const std::vector<float> band = band_of(result_.labels, grid_, local_reach);
    for (std::size_t i = 0; i < held_.size(); ++i)
      if (band[i] > 0) held_[i] = set_.force[i];
  }

  // A start that is too small for the lattice, as a single voxel may be, grows until it is not.
  void start() {
    for (;;) {
      hold_voxels();
      fit_target(lattice_, step_, local_first_fit, set_.coefficients);
      std::vector<std::uint8_t> shown = result_.labels;
      update_labels(lattice_, set_.coefficients, shown.data());
      const Index voxels = inside(result_.labels);
      if (2 * inside(shown) >= voxels) break;
      const std::vector<float> edge = band_of(result_.labels, grid_, 0);
      for (std::size_t i = 0; i < edge.size(); ++i)
        if (edge[i] > 0) result_.labels[i] = 1;
      leave_masked(result_.labels, std::uint8_t{0});
      if (inside(result_.labels) == voxels) break;
    }
    source_.fit(result_.labels);
    source_.force(1, 1, set_.force);
    scale_ = force_scale(set_.force);
    take_force();
    set_.energy.eps = step_.eps =
        std::max({local_least_eps, noise_to_eps * options_.noise, least_width(lattice_, set_.energy)});
    energy_ = set_.total(lattice_);
    add_energy();
  }

  // Beyond the mask nothing else would stop the contour, which comes in again on the other side.
  void take_force() {
    set_.others = source_.force_with_prior(1, scale_, set_.force);
    leave_masked(set_.force, masked_force);
  }

  void add_energy() { result_.energy.push_back(energy_ / static_cast<double>(held_.size())); }

  // False when the energy falls no further.
  bool move_contour() {
    hold_all_but_band();
    const std::vector<float> before = set_.coefficients;
    fit_target(lattice_, step_, local_fit, set_.coefficients);
    std::vector<double> steps;
    minimize_contour_energy(lattice_, step_, local_descent, descent_tolerance, set_.coefficients, steps);
    const double next = set_.total(lattice_);
    // A start that the lattice cannot represent is left behind.
    if (next > energy_ && result_.iterations == 1) result_.energy.clear();
    if (next > energy_ && result_.iterations > 1) {
      set_.coefficients = before;
      result_.converged = true;
      return false;
    }
    energy_ = next;
    const Index changed = update_labels(lattice_, set_.coefficients, result_.labels.data());
    result_.converged = static_cast<double>(changed) <= 0.1 * changed_share * static_cast<double>(held_.size());
    return true;
  }

  // New statistics, if they are better for the contour as it is.
  void update_statistics() {
    source_.fit(result_.labels);
    take_force();
    const double next = set_.total(lattice_);
    if (next <= energy_) {
      energy_ = next;
      return;
    }
    source_.undo();
    take_force();
  }

  void fill_holes() {
    std::vector<std::uint8_t>& labels = result_.labels;
    if (fill_enclosed(labels, grid_, options_.seeds) == 0) return;
    leave_masked(labels, std::uint8_t{0});
    hold_all_but_band();
    fit_target(lattice_, step_, local_first_fit, set_.coefficients);
    update_labels(lattice_, set_.coefficients, labels.data());
    fill_enclosed(labels, grid_, options_.seeds);
    leave_masked(labels, std::uint8_t{0});
  }

  const Lattice<Dim>& lattice_;
  ForceSource& source_;
  const VariationalOptions& options_;
  const Grid& grid_;
  VariationalResult result_;
  LevelSet<Dim> set_;
  std::vector<float> held_;
  ContourEnergy step_;  // of the voxels as they are held
  double scale_ = 1, energy_ = 0;
};

}  // namespace

template <int Dim>
VariationalResult descend_globally(const Lattice<Dim>& lattice, ForceSource& source, const VariationalOptions& options,
                                   std::vector<std::uint8_t> labels) {
  return GlobalDescent<Dim>(lattice, source, options, std::move(labels)).run();
}

template <int Dim>
VariationalResult descend_locally(const Lattice<Dim>& lattice, ForceSource& source, const VariationalOptions& options,
                                  const Grid& grid, std::vector<std::uint8_t> labels) {
  return LocalDescent<Dim>(lattice, source, options, grid, std::move(labels)).run();
}

#define CSRBF_INSTANTIATE(Dim)                                                                                   \
  template VariationalResult descend_globally<Dim>(const Lattice<Dim>&, ForceSource&, const VariationalOptions&, \
                                                   std::vector<std::uint8_t>);                                   \
  template VariationalResult descend_locally<Dim>(const Lattice<Dim>&, ForceSource&, const VariationalOptions&,  \
                                                  const Grid&, std::vector<std::uint8_t>);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
