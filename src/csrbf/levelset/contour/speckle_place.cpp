#include "csrbf/levelset/contour/speckle_place.hpp"

#include "csrbf/levelset/contour/contour_energy.hpp"
#include "csrbf/levelset/contour/speckle_contour.hpp"
#include "csrbf/levelset/regions/region_cores.hpp"

namespace csrbf {

template <int Dim>
std::optional<SpecklePlace<Dim>> find_speckle_place(std::span<const float> values, const Grid& grid,
                                                    std::span<const std::uint8_t> mask, std::span<const float> prior,
                                                    const LatticeOptions& centers, bool keeps_centers,
                                                    const std::vector<std::uint8_t>& labels,
                                                    const std::vector<float>& coefficients) {
  std::vector<std::uint8_t> inside = labels;
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[i] == 0) inside[i] = no_region;
  const std::optional<SpeckleModel> speckle = find_speckle<Dim>(values, grid, inside);
  if (!speckle) return std::nullopt;
  LatticeOptions used = centers;
  if (!keeps_centers) used.center_spacing = std::max(used.center_spacing, spacing_in_speckle<Dim>(*speckle, grid));
  SpecklePlace<Dim> place{
      Lattice<Dim>(grid.size, grid.spacing, used), used.center_spacing, coefficients, labels, speckle->exponent, {}};
  if (!keeps_centers) place.coefficients = coefficients_of_labels(place.lattice, labels);
  const std::vector<float> start = place.coefficients;
  SpeckleContour<Dim> contour(place.lattice, *speckle, values, mask, prior, start);
  place.coefficients = contour.descend(place.steps);
  update_labels(place.lattice, place.coefficients, place.labels.data());
  return place;
}

template std::optional<SpecklePlace<2>> find_speckle_place<2>(std::span<const float>, const Grid&,
                                                              std::span<const std::uint8_t>, std::span<const float>,
                                                              const LatticeOptions&, bool,
                                                              const std::vector<std::uint8_t>&,
                                                              const std::vector<float>&);
template std::optional<SpecklePlace<3>> find_speckle_place<3>(std::span<const float>, const Grid&,
                                                              std::span<const std::uint8_t>, std::span<const float>,
                                                              const LatticeOptions&, bool,
                                                              const std::vector<std::uint8_t>&,
                                                              const std::vector<float>&);

}  // namespace csrbf
