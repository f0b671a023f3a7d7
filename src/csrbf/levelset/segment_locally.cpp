#include "csrbf/levelset/segment_locally.hpp"

#include "csrbf/levelset/partition/two_means_price.hpp"
#include "csrbf/levelset/segment_checks.hpp"

namespace csrbf {

// A contour of variances is often the better one for means, too: it does not leak where means say little.
template <int Dim>
Segmentation<Dim> segment_by_best_energy(const Volume<float>& image, SegmentOptions options) {
  options.energy = SegmentEnergy::chan_vese;
  Segmentation<Dim> means = segment<Dim>(image, options);
  options.energy = SegmentEnergy::gaussian;
  Segmentation<Dim> variances = segment<Dim>(image, options);
  const std::vector<float> repaired = finite_values(image, options.mask);
  const TwoMeansPrices prices = two_means_prices(repaired.empty() ? image.values : repaired, image.grid, options.mask,
                                                 contour_length, means.labels, variances.labels);
  Segmentation<Dim>& best = prices.second_is_better ? variances : means;
  best.report.prices = {{SegmentEnergy::chan_vese, Shading::none, prices.first},
                        {SegmentEnergy::gaussian, Shading::none, prices.second}};
  return std::move(best);
}

template Segmentation<2> segment_by_best_energy<2>(const Volume<float>&, SegmentOptions);
template Segmentation<3> segment_by_best_energy<3>(const Volume<float>&, SegmentOptions);

}  // namespace csrbf
