#pragma once

#include "csrbf/levelset/partition/seed_prior.hpp"
#include "csrbf/levelset/partition/two_means_price.hpp"
#include "csrbf/levelset/segment_checks.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace csrbf {

/// Voxels of the shortest edge between centres that are dense enough for a ball of so many voxels.
double spacing_for_ball(const Grid& grid, double voxels);

/// options.prior, the core of the seed inside, and what is farther outside the labels than `distance`, outside.
std::vector<float> prior_near(const SegmentOptions& options, const Grid& grid, std::span<const std::uint8_t> labels,
                              double distance);

/// What the seed or seeds lie in (find_seed_tissue()), a rim around it included, and warnings of what was left
/// undecided.
struct LocalTissue {
  std::vector<std::uint8_t> labels;  ///< none where no scale shows a tissue of one intensity
  std::vector<std::string> warnings;
  double noise = 0;    ///< its standard deviation in the image
  bool noisy = false;  ///< two means, of all inside and all outside, tell more than those near the contour
};
LocalTissue tissue_at_seed(std::span<const float> values, const SegmentOptions& options, const Grid& grid);

/// The options to follow the contour of a tissue: forces from rings on both sides of it (ring_force()), and centres as
/// far apart as the noise asks for.
struct TissueContour {
  SegmentOptions options;
  double noise = 0;  ///< over the contrast at the contour; not of a noisy tissue
};
TissueContour following_tissue(const SegmentOptions& options, std::span<const float> values, const Grid& grid,
                               const LocalTissue& tissue, const std::vector<std::uint8_t>& labels);

/// A contour of variances is often the better one for means, too: it does not leak where means say little.
template <class Once>
auto segment_by_best_energy(const Volume<float>& image, SegmentOptions options, const Once& once) {
  options.energy = SegmentEnergy::chan_vese;
  auto means = once(options);
  options.energy = SegmentEnergy::gaussian;
  auto variances = once(options);
  const std::vector<float> repaired = finite_values(image, options.mask);
  const TwoMeansPrices prices = two_means_prices(repaired.empty() ? image.values : repaired, image.grid, options.mask,
                                                 contour_length, means.labels, variances.labels);
  auto& best = prices.second_is_better ? variances : means;
  best.report.prices = {{SegmentEnergy::chan_vese, Shading::none, prices.first},
                        {SegmentEnergy::gaussian, Shading::none, prices.second}};
  return std::move(best);
}

/// Goes on from where the contour came to rest, until it stays there. What coarse centres smoothed away lies between
/// them, so that no contour has to leak to find it.
template <class Once, class Found>
Found follow_contour(const Grid& grid, SegmentOptions options, const Once& once, Found found) {
  constexpr int rounds = 4;          // at most
  constexpr double at_rest = 0.005;  // of the voxels inside may change; by hand
  const double edge = grid.spacing.head(grid.dimension()).minCoeff();
  const auto inside = [](const Found& of) {
    return static_cast<double>(std::count(of.labels.begin(), of.labels.end(), std::uint8_t{1}));
  };
  options.energy = found.report.options.energy;
  options.prior = prior_near(options, grid, found.labels, *found.report.options.center_spacing * edge);
  options.seed.clear();
  const bool given = options.center_spacing.has_value();
  for (int round = 0; round < rounds && inside(found) > 0; ++round) {
    options.start = found.labels;
    if (!given)
      options.center_spacing = std::min(*found.report.options.center_spacing, spacing_for_ball(grid, inside(found)));
    Found next = once(options);
    if (inside(next) == 0) break;
    double changed = 0;
    for (std::size_t i = 0; i < next.labels.size(); ++i) changed += next.labels[i] != found.labels[i] ? 1 : 0;
    const bool rests = changed <= at_rest * inside(found);
    next.report.iterations += found.report.iterations;
    next.report.prices = std::move(found.report.prices);
    found = std::move(next);
    if (rests) break;
  }
  return found;
}

/// The contour of the tissue that the seed lies in. Many tissues may lie beyond, which the law of one outside cannot
/// describe.
template <class Once>
auto follow_tissue(std::span<const float> values, const Grid& grid, const SegmentOptions& options, const Once& once,
                   const LocalTissue& tissue) {
  auto found = once(following_tissue(options, values, grid, tissue, tissue.labels).options);
  auto [again, noise] = following_tissue(options, values, grid, tissue, found.labels);
  const auto inside = static_cast<double>(std::count(found.labels.begin(), found.labels.end(), std::uint8_t{1}));
  if (!again.center_spacing)
    again.center_spacing = std::min(*found.report.options.center_spacing, spacing_for_ball(grid, inside));
  const int before = found.report.iterations;
  found = once(again);
  found.report.iterations += before;
  if (!tissue.noisy) found.report.noise = noise;
  return found;
}

/// A contour that moves from its seed, seeds or start, where `once` segments with given options: of the energy that
/// describes the image better, where that may be chosen. From a seed or seeds, unless there is a force, once more from
/// where it came to rest, on centres no farther apart than the size of what it found asks for, until it stays. The core
/// of a `start` tells the tissue, too, but is not kept.
template <class Once>
auto segment_locally(const Volume<float>& image, SegmentOptions options, const Once& once) {
  const bool started = !options.start.empty();
  if (!started && options.seed.empty()) options = starting_at_seeds(std::move(options));
  if (!chooses_local_energy(options, image.grid.voxels())) {
    auto found = once(options);
    return started || options.force ? found : follow_contour(image.grid, options, once, std::move(found));
  }
  const std::vector<float> repaired = finite_values(image, options.mask);
  const std::span<const float> values = repaired.empty() ? std::span<const float>(image.values) : repaired;
  const LocalTissue tissue = tissue_at_seed(values, options, image.grid);
  auto found = !tissue.labels.empty() ? follow_tissue(values, image.grid, options, once, tissue)
                                      : segment_by_best_energy(image, options, once);
  if (tissue.labels.empty() && !started) found = follow_contour(image.grid, options, once, std::move(found));
  std::vector<std::string>& warnings = found.report.warnings;
  warnings.insert(warnings.end(), tissue.warnings.begin(), tissue.warnings.end());
  return found;
}

}  // namespace csrbf
