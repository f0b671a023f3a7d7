#include "csrbf/levelset/local_energy.hpp"

#include "csrbf/levelset/partition/partition_model.hpp"
#include "csrbf/levelset/regions/intensity_histogram.hpp"
#include "csrbf/levelset/segment_checks.hpp"

#include <algorithm>

namespace csrbf {

bool chooses_local_energy(const SegmentOptions& options, Index voxels) {
  return options.energy == SegmentEnergy::automatic && options.mode == SegmentMode::local &&
         options.method == SegmentMethod::variational && !options.force && options.prior.empty() && !options.window &&
         !options.smoothness && voxels <= most_chosen_voxels;
}

template <int Dim>
Segmentation<Dim> segment_by_best_energy(const Volume<float>& image, SegmentOptions options) {
  constexpr double clearly = 0.1;  // of the price of the contour; by hand: less is a matter of chance
  options.energy = SegmentEnergy::chan_vese;
  Segmentation<Dim> means = segment<Dim>(image, options);
  options.energy = SegmentEnergy::gaussian;
  Segmentation<Dim> variances = segment<Dim>(image, options);

  const std::vector<float> repaired = finite_values(image, options.mask);
  const std::span<const float> values = repaired.empty() ? std::span<const float>(image.values) : repaired;
  const IntensityBins bins = choose_bins(values, 256, options.mask);
  const ContourWeight weight = contour_weight(image.grid, contour_length);
  PartitionPrice price(values, bins.lo, bins.hi, image.grid, options.mask, weight);
  const double of_means = price.fit(means.labels, {}), of_variances = price.fit(variances.labels, {});
  const double contour = contour_price(means.labels, 1, image.grid.size, weight);
  const bool better = of_variances < of_means - clearly * contour;
  Segmentation<Dim>& best = better ? variances : means;
  const double least = better ? of_variances : of_means;
  best.report.prices = {{SegmentEnergy::chan_vese, Shading::none, of_means - least},
                        {SegmentEnergy::gaussian, Shading::none, of_variances - least}};
  return std::move(best);
}

template Segmentation<2> segment_by_best_energy<2>(const Volume<float>&, SegmentOptions);
template Segmentation<3> segment_by_best_energy<3>(const Volume<float>&, SegmentOptions);

}  // namespace csrbf
