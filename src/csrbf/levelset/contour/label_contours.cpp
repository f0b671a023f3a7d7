#include "csrbf/levelset/contour/label_contours.hpp"

#include "csrbf/levelset/contour/contour_energy.hpp"
#include "csrbf/levelset/regions/force_noise.hpp"
#include "csrbf/levelset/regions/region_labels.hpp"

namespace csrbf {
namespace {

constexpr int label_fit_steps = 12;         // of conjugate gradients; by hand: more change no label
constexpr int label_side_steps = 40;        // to bring voxels to their side; by hand: most end after 5 to 15
constexpr double label_side_margin = 0.05;  // |f| that voxels are pushed to; by hand
constexpr float doubtful = 0.3F;  // |force| of voxels that the contour leaves on the side they do not favour; by hand
constexpr double noisy = 0.005;   // share of such voxels above which forces say nothing about single voxels; by hand

// -1 and 1 by the labels, with the size of the forces where these agree.
std::vector<float> guide(std::span<const float> force, const std::vector<std::uint8_t>& labels, std::uint8_t label) {
  std::vector<float> to(labels.size());
  const auto side = [&](std::size_t i) { return labels[i] == label ? -1.0F : 1.0F; };
  double wrong = 0;
  const double scale = force.empty() ? 1 : std::max(mean_magnitude(force), 1e-30);
  for (std::size_t i = 0; i < force.size(); ++i) wrong += force[i] * side(i) < 0 ? 1 : 0;
  const bool plain = force.empty() || wrong > noisy * static_cast<double>(labels.size());
  for (std::size_t i = 0; i < to.size(); ++i) {
    const float size = plain ? 2.0F : std::abs(static_cast<float>(static_cast<double>(force[i]) / scale));
    to[i] = side(i) * (!plain && force[i] * side(i) < 0 ? doubtful : std::max(size, doubtful));
  }
  return to;
}

// Brings the voxels whose labels change to the other side; f stays as it is at the others.
template <int Dim>
void move_voxels(const Lattice<Dim>& lattice, const std::vector<std::uint8_t>& from,
                 const std::vector<std::uint8_t>& to, std::vector<float>& coefficients) {
  std::vector<float> force(from.size());
  lattice.sweep(
      coefficients.data(), false,
      [&](const LatticeRow& row) {
        for (Index i = 0; i < row.count; ++i) {
          const auto voxel = static_cast<std::size_t>(row.voxel + i * row.stride);
          force[voxel] = to[voxel] == from[voxel] ? -2 * row.value[i] : to[voxel] == 0 ? 2.0F : -2.0F;
        }
        return 0.0;
      },
      nullptr);
  fit_target(lattice, ContourEnergy{force.data()}, label_fit_steps, coefficients);
  separate_voxels(lattice, force.data(), label_side_margin, label_side_steps, coefficients);
}

}  // namespace

template <int Dim>
std::vector<std::vector<float>> label_contours(const Lattice<Dim>& lattice, std::span<const float> force, int regions,
                                               std::vector<std::uint8_t>& labels) {
  std::vector<std::vector<float>> sets;
  for (int k = regions == 2 ? 1 : 0; k < regions; ++k) {
    const std::vector<float> wanted = guide(force, labels, static_cast<std::uint8_t>(k));
    std::vector<float> coefficients(static_cast<std::size_t>(lattice.array_size()), 0.0F);
    fit_target(lattice, ContourEnergy{wanted.data()}, label_fit_steps, coefficients);
    separate_voxels(lattice, wanted.data(), label_side_margin, label_side_steps, coefficients);
    sets.push_back(std::move(coefficients));
  }
  if (regions == 2) {
    update_labels(lattice, sets[0], labels.data());
    return sets;
  }
  std::vector<const float*> coefficients;
  coefficients.reserve(sets.size());
  for (const std::vector<float>& set : sets) coefficients.push_back(set.data());
  update_labels(lattice, coefficients, labels);
  return sets;
}

template <int Dim>
void correct_labels(const Lattice<Dim>& lattice, const Grid& grid, const SegmentOptions& options,
                    std::vector<std::uint8_t>& labels, std::vector<std::vector<float>>& coefficients) {
  std::vector<std::uint8_t> wanted = labels;
  if (options.fill_holes.value_or(false)) fill_enclosed(wanted, grid, options.seeds);
  for (std::size_t i = 0; i < options.mask.size(); ++i)
    if (options.mask[i] == 0) wanted[i] = 0;
  if (wanted == labels) return;
  if (options.regions == 2) {
    move_voxels(lattice, labels, wanted, coefficients[0]);
    labels = std::move(wanted);
  } else {
    labels = wanted;
    coefficients = label_contours(lattice, {}, options.regions, wanted);
  }
}

template void correct_labels<2>(const Lattice<2>&, const Grid&, const SegmentOptions&, std::vector<std::uint8_t>&,
                                std::vector<std::vector<float>>&);
template void correct_labels<3>(const Lattice<3>&, const Grid&, const SegmentOptions&, std::vector<std::uint8_t>&,
                                std::vector<std::vector<float>>&);
template std::vector<std::vector<float>> label_contours<2>(const Lattice<2>&, std::span<const float>, int,
                                                           std::vector<std::uint8_t>&);
template std::vector<std::vector<float>> label_contours<3>(const Lattice<3>&, std::span<const float>, int,
                                                           std::vector<std::uint8_t>&);

}  // namespace csrbf
