#include "csrbf/levelset/contour/speckle_contour.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/parallel_sum.hpp"
#include "csrbf/levelset/contour/contour_energy.hpp"
#include "csrbf/levelset/contour/segment_fields.hpp"
#include "csrbf/levelset/contour/spectral_descent.hpp"
#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "csrbf/levelset/lattice/coefficient_sums.hpp"

#include <numbers>

namespace csrbf {
namespace {

constexpr Index voxels_per_thread = 1 << 14;

// H_eps and its derivative by f / eps; see ContourEnergy.
float step_at(float t) {
  t = std::clamp(t, -1.0F, 1.0F);
  return 0.5F + t * (0.9375F - t * t * (0.625F - t * t * 0.1875F));
}
float bump_at(float t) {
  const float rest = 1 - t * t;
  return rest > 0 ? 0.9375F * rest * rest : 0.0F;
}

// Shortest edge of a voxel.
double unit_of(const Point<3>& spacing, int dimension) {
  return spacing.head(dimension).minCoeff();
}

}  // namespace

template <int Dim>
double spacing_in_speckle(const SpeckleModel& model, const Grid& grid) {
  constexpr double grains = 6;  // by hand: closer centres follow single grains, wider ones lose detail
  double width = 0;             // the mean of the axes
  for (Index a = 0; a < Dim; ++a) width += model.grain[a] * grid.spacing[a] / unit_of(grid.spacing, Dim) / Dim;
  return std::round(std::clamp(grains * width, 2.0, 24.0));
}

template <int Dim>
std::vector<float> coefficients_of_labels(const Lattice<Dim>& lattice, std::span<const std::uint8_t> labels) {
  constexpr int steps = 6;  // of conjugate gradients, as in the start of a descent
  std::vector<float> force(labels.size()), coefficients(static_cast<std::size_t>(lattice.array_size()), 0.0F);
  for (std::size_t i = 0; i < force.size(); ++i) force[i] = labels[i] != 0 ? -1.0F : 1.0F;
  ContourEnergy energy;
  energy.force = force.data();
  fit_target(lattice, energy, steps, coefficients);
  return coefficients;
}

template <int Dim>
SpeckleContour<Dim>::SpeckleContour(const Lattice<Dim>& lattice, const SpeckleModel& model,
                                    std::span<const float> values, std::span<const std::uint8_t> mask,
                                    std::span<const float> prior, const std::vector<float>& start)
    : lattice_(lattice),
      model_(model),
      mask_(mask),
      prior_(prior),
      start_(start),
      powers_(values.size()),
      share_(values.size()),
      grain_(model.voxels_per_grain()) {
  constexpr double drift = 2;  // grains; by hand: larger follows noise, smaller stays at the start
  const double unit = unit_of(lattice.spacing(), Dim);
  double width = 1;
  for (Index a = 0; a < Dim; ++a) {
    blur_[a] = model.grain[a] / std::numbers::sqrt2;  // the square of a Gaussian
    width = std::max(width, model.grain[a] * lattice.spacing()[a] / unit);
  }
  const double slope = contour_slope(lattice, start_) * unit;
  eps_ = slope > 0 ? slope : 1;  // H rises within a voxel on each side
  stiffness_ = std::pow(eps_ * drift * width, -2);
  parallel_for(std::ssize(powers_), voxels_per_thread, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      powers_[i] = static_cast<float>(model_.power_of(static_cast<double>(values[i])));
  });
  // About what a voxel at the contour says.
  prior_scale_ = 2 * std::abs(model_.power[1] - model_.power[0]) / (model_.power[1] + model_.power[0]) / grain_;
}

template <int Dim>
double SpeckleContour<Dim>::prior_energy() const {
  if (prior_.empty()) return 0;
  return prior_scale_ * parallel_sum(std::ssize(share_), voxels_per_thread, [&](Index begin, Index end) {
           double part = 0;
           for (Index i = begin; i < end; ++i) part += static_cast<double>(prior_[i] * share_[i]);
           return part;
         });
}

// Terms of the powers seen, their derivatives by the blurred share in its place.
template <int Dim>
double SpeckleContour<Dim>::power_energy() {
  const auto low = static_cast<float>(model_.power[0]), gap = static_cast<float>(model_.power[1] - model_.power[0]);
  const auto weight = static_cast<float>(1 / grain_);
  return parallel_sum(std::ssize(share_), voxels_per_thread, [&](Index begin, Index end) {
    double sum = 0;
    for (Index i = begin; i < end; ++i) {
      const float power = low + gap * share_[i], seen = powers_[i] / power;
      const bool takes_part = mask_.empty() || mask_[i] != 0;
      sum += takes_part ? static_cast<double>(weight * (seen + std::log(power))) : 0.0;
      share_[i] = takes_part ? weight * gap * (1 - seen) / power : 0.0F;
    }
    return sum;
  });
}

template <int Dim>
double SpeckleContour<Dim>::energy(const float* coefficients, float* derivatives) {
  const auto inverse_eps = static_cast<float>(1 / eps_), prior_scale = static_cast<float>(prior_scale_);
  const auto n = static_cast<std::size_t>(lattice_.coefficients());
  lattice_.sweep(
      coefficients, false,
      [&](const LatticeRow& row) {
        for (Index i = 0; i < row.count; ++i) share_[row.voxel + i * row.stride] = step_at(row.value[i] * inverse_eps);
        return 0.0;
      },
      nullptr);
  double sum = prior_energy();
  gaussian_blur(share_, lattice_.size(), blur_);
  sum += power_energy();
  sum += 0.5 * stiffness_ * sum_of(n, [&](std::size_t i) {
           const auto off = static_cast<double>(coefficients[i] - start_[i]);
           return off * off;
         });
  if (derivatives == nullptr) return sum;
  gaussian_blur(share_, lattice_.size(), blur_);
  lattice_.sweep(
      coefficients, false,
      [&](const LatticeRow& row) {
        for (Index i = 0; i < row.count; ++i) {
          const auto voxel = static_cast<std::size_t>(row.voxel + i * row.stride);
          const float by_share = share_[voxel] + (prior_.empty() ? 0.0F : prior_scale * prior_[voxel]);
          row.value[i] = inverse_eps * bump_at(row.value[i] * inverse_eps) * by_share;
        }
        return 0.0;
      },
      derivatives);
  for_all(n, [&](std::size_t i) { derivatives[i] += static_cast<float>(stiffness_) * (coefficients[i] - start_[i]); });
  return sum;
}

template <int Dim>
std::vector<float> SpeckleContour<Dim>::descend(std::vector<double>& energies) {
  constexpr int evaluations = 30;  // by hand: the start is close
  constexpr float farthest = 4;    // coefficients start from at most 2
  std::vector<float> coefficients = start_;
  spectral_descent([&](const float* x, float* derivatives) { return energy(x, derivatives); },
                   {farthest, 1 / stiffness_, evaluations, 1e-3}, coefficients, energies);
  return coefficients;
}

#define CSRBF_INSTANTIATE(Dim)                                                                                 \
  template double spacing_in_speckle<Dim>(const SpeckleModel&, const Grid&);                                   \
  template std::vector<float> coefficients_of_labels<Dim>(const Lattice<Dim>&, std::span<const std::uint8_t>); \
  template class SpeckleContour<Dim>;
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
