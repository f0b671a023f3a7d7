#include "csrbf/levelset/segment_local.hpp"

#include "csrbf/levelset/image/signed_distance.hpp"
#include "csrbf/levelset/partition/seed_prior.hpp"
#include "csrbf/levelset/partition/two_means_price.hpp"
#include "csrbf/levelset/segment_checks.hpp"

#include <numbers>

namespace csrbf {
namespace {

// A contour of variances is often the better one for means, too: it does not leak where means say little.
template <int Dim>
Segmentation<Dim> segment_by_best_energy(const Volume<float>& image, SegmentOptions options,
                                         const SegmentOnce<Dim>& once) {
  options.energy = SegmentEnergy::chan_vese;
  Segmentation<Dim> means = once(options);
  options.energy = SegmentEnergy::gaussian;
  Segmentation<Dim> variances = once(options);
  const std::vector<float> repaired = finite_values(image, options.mask);
  const TwoMeansPrices prices = two_means_prices(repaired.empty() ? image.values : repaired, image.grid, options.mask,
                                                 contour_length, means.labels, variances.labels);
  Segmentation<Dim>& best = prices.second_is_better ? variances : means;
  best.report.prices = {{SegmentEnergy::chan_vese, Shading::none, prices.first},
                        {SegmentEnergy::gaussian, Shading::none, prices.second}};
  return std::move(best);
}

double shortest_edge(const Grid& grid) {
  return *std::min_element(grid.spacing.data(), grid.spacing.data() + grid.dimension());
}

// Of a ball of as many voxels, in units of the shortest edge.
double radius(const Grid& grid, double voxels) {
  const double unit = shortest_edge(grid);
  double volume = voxels;
  for (int a = 0; a < grid.dimension(); ++a) volume *= grid.spacing[a] / unit;
  return grid.dimension() == 2 ? std::sqrt(volume / std::numbers::pi) : std::cbrt(0.75 * volume / std::numbers::pi);
}

// What is farther outside the labels than that stays outside.
void keep_near(const Grid& grid, std::span<const std::uint8_t> labels, double distance, std::vector<float>& prior) {
  const std::vector<float> inside = signed_distance(grid, labels.data());
  prior.resize(labels.size(), 0.0F);
  for (std::size_t i = 0; i < inside.size(); ++i)
    if (static_cast<double>(inside[i]) < -distance) prior[i] += certain_prior;
}

// Goes on from where the contour came to rest, until it stays there. What coarse centres smoothed away lies between
// them, so that no contour has to leak to find it.
template <int Dim>
Segmentation<Dim> follow(const Grid& grid, SegmentOptions options, const SegmentOnce<Dim>& once,
                         Segmentation<Dim> found) {
  constexpr int rounds = 4;          // at most
  constexpr double at_rest = 0.005;  // of the voxels inside may change; by hand
  constexpr double finest = 2;       // voxels between centres; by hand: less follows noise
  constexpr double per_radius = 3;   // centres; by hand: fewer shrink balls, more follow noise
  options.energy = found.report.options.energy;
  options.prior = seed_prior(options, grid);
  options.seed.clear();
  const bool given = options.center_spacing.has_value();
  keep_near(grid, found.labels, *found.report.options.center_spacing * shortest_edge(grid), options.prior);
  for (int round = 0; round < rounds; ++round) {
    const auto inside = static_cast<double>(std::count(found.labels.begin(), found.labels.end(), std::uint8_t{1}));
    if (inside == 0) break;
    options.start = found.labels;
    const double coarsest = std::max(finest, radius(grid, inside) / per_radius);
    if (!given) options.center_spacing = std::min(*found.report.options.center_spacing, coarsest);
    Segmentation<Dim> next = once(options);
    if (std::count(next.labels.begin(), next.labels.end(), std::uint8_t{1}) == 0) break;
    double changed = 0;
    for (std::size_t i = 0; i < next.labels.size(); ++i) changed += next.labels[i] != found.labels[i] ? 1 : 0;
    next.report.iterations += found.report.iterations;
    next.report.prices = std::move(found.report.prices);
    found = std::move(next);
    if (changed <= at_rest * inside) break;
  }
  return found;
}

}  // namespace

template <int Dim>
Segmentation<Dim> segment_locally(const Volume<float>& image, SegmentOptions options, const SegmentOnce<Dim>& once) {
  const bool started = !options.start.empty();
  if (!started && options.seed.empty()) options = starting_at_seeds(std::move(options));
  const bool chooses = chooses_local_energy(options, image.grid.voxels());
  Segmentation<Dim> found = chooses ? segment_by_best_energy<Dim>(image, options, once) : once(options);
  return started || options.force ? found : follow<Dim>(image.grid, options, once, std::move(found));
}

template Segmentation<2> segment_locally<2>(const Volume<float>&, SegmentOptions, const SegmentOnce<2>&);
template Segmentation<3> segment_locally<3>(const Volume<float>&, SegmentOptions, const SegmentOnce<3>&);

}  // namespace csrbf
