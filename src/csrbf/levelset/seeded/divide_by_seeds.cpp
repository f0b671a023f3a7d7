#include "csrbf/levelset/seeded/divide_by_seeds.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/levelset/convex/potts_contours.hpp"
#include "csrbf/levelset/image/noise_grain.hpp"
#include "csrbf/levelset/partition/nearest_component.hpp"
#include "csrbf/levelset/seeded/nearest_seeds.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace csrbf {
namespace {

constexpr double chance = 3;            // deviations that means of noise differ by; by hand
constexpr double most_apart = 2;        // deviations that means of seeds differ by at most; by hand
constexpr std::uint8_t no_label = 255;  // outside the mask

using LabelPair = std::array<int, 2>;

// Connected parts of all labels.
struct LabelParts {
  std::vector<std::int32_t> of_voxel;  // -1: outside the mask
  std::vector<std::uint8_t> labels;
};

LabelParts parts_of(std::span<const std::uint8_t> labels, int regions, const Grid& grid) {
  LabelParts parts;
  parts.of_voxel.assign(labels.size(), -1);
  for (int k = 0; k < regions; ++k) {
    const auto label = static_cast<std::uint8_t>(k);
    const VoxelComponents found = voxel_components(labels, label, grid);
    const auto first = static_cast<std::int32_t>(parts.labels.size());
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (found.component[i] >= 0) parts.of_voxel[i] = first + found.component[i];
    parts.labels.resize(parts.labels.size() + found.count, label);
  }
  return parts;
}

// What is known of labels with seeds.
struct SeededRegions {
  std::vector<double> means, counts;         // of the seeds, in deviations
  std::vector<std::vector<double>> squares;  // of what the mean of each region leaves of the seeds of each, on average
  LabelMeasures measures;
  double deviation = 0, grain = 1;  // of what the means leave of the image

  // Another region is more like the seeds than their own, as where that became the blurred border of both: by much for
  // each voxel, and by more for all than chance gives.
  [[nodiscard]] bool drifted(std::size_t own, std::size_t other) const {
    constexpr double of_each = 1, of_all = 8;  // squared deviations, by hand; chance gives 8 once in 400 times
    const double more = squares[own][own] - squares[own][other];
    return more > of_each && counts[own] * more > of_all * grain;
  }
  [[nodiscard]] bool may_be_alike(std::size_t one, std::size_t other) const {
    if (counts[one] == 0 || counts[other] == 0) return false;
    return std::abs(means[one] - means[other]) < most_apart + chance * std::sqrt(1 / counts[one] + 1 / counts[other]);
  }
};

SeededRegions measure_seeded(PartitionPrice& price, std::span<const std::uint8_t> seeds, int regions,
                             const Partition& found, double deviation, double grain) {
  const auto n = static_cast<std::size_t>(regions);
  SeededRegions result{std::vector<double>(n, 0),
                       std::vector<double>(n, 0),
                       std::vector<std::vector<double>>(n, std::vector<double>(n, 0)),
                       price.measure(found.labels, regions),
                       deviation,
                       grain};
  for (std::size_t i = 0; i < seeds.size(); ++i)
    if (seeds[i] != 0) {
      result.means[seeds[i] - 1] += static_cast<double>(price.values()[i]);
      result.counts[seeds[i] - 1] += 1;
    }
  for (std::size_t k = 0; k < n; ++k) {
    const std::vector<float> rest = price.rest(std::vector<std::uint8_t>(seeds.size(), static_cast<std::uint8_t>(k)));
    for (std::size_t i = 0; i < seeds.size(); ++i)
      if (seeds[i] != 0) result.squares[seeds[i] - 1][k] += std::pow(static_cast<double>(rest[i]) / deviation, 2);
  }
  for (std::size_t k = 0; k < n; ++k) {
    result.means[k] /= deviation * std::max(1.0, result.counts[k]);
    for (double& each : result.squares[k]) each /= std::max(1.0, result.counts[k]);
  }
  return result;
}

// Two regions describe their voxels in fewer nats than one for both.
bool tells_apart(const PartitionPrice& price, const SeededRegions& regions, const Partition& found, std::uint8_t one,
                 std::uint8_t other) {
  const int degree = std::min(static_cast<int>(found.model.shape), static_cast<int>(MeanShape::quadratic));
  const auto left = [&](const RegionMoments& moments) {
    return MeanPolynomial(moments, degree, price.grid()).residual(moments);
  };
  const RegionMoments& first = regions.measures.regions[one];
  RegionMoments both = first;
  both.add(regions.measures.regions[other]);
  const double squares = left(both) - left(first) - left(regions.measures.regions[other]);
  std::vector<std::uint8_t> joined = found.labels;
  std::replace(joined.begin(), joined.end(), other, one);
  const auto contour = [&](std::span<const std::uint8_t> labels, std::uint8_t label) {
    return 0.5 * contour_price(labels, label, price.grid().size, price.weight());
  };
  const double border = contour(found.labels, one) + contour(found.labels, other) - contour(joined, one);
  const double parameters = static_cast<double>(MeanPolynomial(first, degree, price.grid()).parameters());
  return squares / (2 * regions.deviation * regions.deviation * regions.grain) >
         border + 0.5 * parameters * std::log(price.voxels());
}

// The class of each label, from 0 on: labels that are not told apart have one.
std::vector<std::uint8_t> label_classes(const PartitionPrice& price, const SeededRegions& regions,
                                        const Partition& found) {
  const std::size_t n = regions.means.size();
  DisjointSets sets(n);
  for (std::uint8_t k = 0; k < n; ++k)
    for (std::uint8_t l = k + 1; l < n; ++l)
      if (regions.may_be_alike(k, l) &&
          (regions.drifted(k, l) || regions.drifted(l, k) || !tells_apart(price, regions, found, k, l)))
        sets.unite(k, l);
  std::vector<std::uint8_t> classes(n);
  std::uint8_t count = 0;
  for (std::uint8_t k = 0; k < n; ++k) {
    const std::size_t first = sets.find(k);
    classes[k] = first == k ? count++ : classes[first];
  }
  return classes;
}

// Statistics and contours in turns.
void follow_contours(PartitionPrice& price, const PartitionModel& model, int regions,
                     std::vector<std::uint8_t>& labels) {
  constexpr int rounds = 4;  // by hand: most of what changes does in the first two
  std::vector<std::vector<float>> costs(static_cast<std::size_t>(regions), std::vector<float>(labels.size()));
  for (int round = 0; round < rounds; ++round) {
    const std::vector<std::uint8_t> before = labels;
    if (!std::isfinite(price.fit(labels, model, regions))) return;
    if (regions == 2) {
      price.force(costs[0]);
      convex_contour(price.grid().size, price.weight(), costs[0], labels);
    } else {
      for (int k = 0; k < regions; ++k) price.cost(k, costs[static_cast<std::size_t>(k)]);
      potts_contours(price.grid().size, price.weight(), costs, labels);
    }
    if (labels == before) return;
  }
}

void add_pairs(const std::set<int>& labels, std::set<LabelPair>& pairs) {
  for (auto one = labels.begin(); one != labels.end(); ++one)
    for (auto other = std::next(one); other != labels.end(); ++other) pairs.insert({*one, *other});
}

// Makes one region of labels of one class and divides it.
AlikeLabels divide_classes(PartitionPrice& price, const SeedCosts& seeds, std::span<const std::uint8_t> certain,
                           std::span<const std::uint8_t> classes, Partition& found) {
  const std::vector<std::uint8_t> before = found.labels;
  std::vector<std::uint8_t> of_class(seeds.labels.begin(), seeds.labels.end()), whole = before;
  for (std::uint8_t& seed : of_class)
    if (seed != 0) seed = classes[seed - 1] + 1;
  for (std::uint8_t& label : whole) label = classes[label];
  const int count = *std::max_element(classes.begin(), classes.end()) + 1;
  price.set_seeds({of_class, seeds.nats});
  follow_contours(price, found.model, count, whole);
  price.set_seeds(seeds);
  std::vector<std::uint8_t> masked = whole;
  for (std::size_t i = 0; i < masked.size(); ++i)
    if (!price.inside(i)) masked[i] = no_label;
  const LabelParts parts = parts_of(masked, count, price.grid());
  std::vector<std::set<int>> labels_in(parts.labels.size());
  for (std::size_t i = 0; i < certain.size(); ++i)
    if (certain[i] != 0 && parts.of_voxel[i] >= 0 && parts.labels[parts.of_voxel[i]] + 1 == of_class[i])
      labels_in[parts.of_voxel[i]].insert(certain[i] - 1);
  // Parts without seeds keep what they were, or get the first label of their class.
  std::vector<std::int32_t> groups = parts.of_voxel;
  for (std::size_t i = 0; i < masked.size(); ++i) {
    if (groups[i] < 0) continue;
    const std::set<int>& labels = labels_in[groups[i]];
    const auto first = std::find(classes.begin(), classes.end(), whole[i]) - classes.begin();
    if (labels.size() == 1)
      found.labels[i] = static_cast<std::uint8_t>(*labels.begin());
    else if (classes[found.labels[i]] != whole[i])
      found.labels[i] = static_cast<std::uint8_t>(first);
    if (labels.size() < 2) groups[i] = -1;
  }
  const std::set<std::int32_t> open = nearest_seeds(price.grid(), groups, certain, found.labels);
  AlikeLabels alike;
  for (std::size_t part = 0; part < labels_in.size(); ++part)
    add_pairs(labels_in[part], open.contains(static_cast<std::int32_t>(part)) ? alike.open : alike.divided);
  if (alike.divided.empty() && !alike.open.empty()) found.labels = before;
  return alike;
}

}  // namespace

AlikeLabels divide_by_seeds(PartitionPrice& price, const SeedCosts& seeds, int regions, Partition& found) {
  if (seeds.labels.empty() || regions < 3) return {};
  std::vector<std::uint8_t> certain(seeds.labels.begin(), seeds.labels.end());
  for (std::size_t i = 0; i < certain.size(); ++i)
    if (!seeds.is_certain(i) || !price.inside(i)) certain[i] = 0;
  price.fit(found.labels, found.model, regions);
  const std::vector<float> rest = price.rest(found.labels);
  double squares = 0;
  for (const float each : rest) squares += static_cast<double>(each) * static_cast<double>(each);
  const double deviation = std::sqrt(squares / price.voxels()) + price.least_deviation();
  const double grain = std::max(price.grain(), noise_grain(rest, price.grid(), price.mask()));
  const std::vector<std::uint8_t> classes =
      label_classes(price, measure_seeded(price, certain, regions, found, deviation, grain), found);
  const int count = *std::max_element(classes.begin(), classes.end()) + 1;
  if (count < 2 || count == regions) return {};
  return divide_classes(price, seeds, certain, classes, found);
}

}  // namespace csrbf
