#include "csrbf/levelset/seeded/divide_by_seeds.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/levelset/image/box_mean.hpp"
#include "csrbf/levelset/image/noise_grain.hpp"
#include "csrbf/levelset/partition/nearest_component.hpp"
#include "csrbf/levelset/partition/potts_contours.hpp"
#include "csrbf/levelset/seeded/nearest_seeds.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace csrbf {
namespace {

constexpr double close_by = 3;          // voxels, of the shortest edge: the blur of most images; by hand
constexpr double chance = 3;            // deviations that means of noise differ by; by hand
constexpr double most_counted = 100;    // voxels on one side, beyond which structures count, not noise; by hand
constexpr double edgeless = 0.5;        // of a border: more is no edge; by hand
constexpr double most_apart = 2;        // deviations that means of seeds differ by at most; by hand
constexpr std::uint8_t no_label = 255;  // outside the mask

using LabelPair = std::array<int, 2>;

// Two neighbours of different labels, and what is close by on both sides.
struct SeedFace {
  std::array<Index, 2> voxels;
  std::array<double, 2> means{}, counts{};
};

// Connected parts of all labels.
struct LabelParts {
  std::vector<std::int32_t> of_voxel;  // -1: outside the mask
  std::vector<Index> voxels;
  std::vector<std::uint8_t> labels;
  std::vector<bool> seeded;  // with the label that the part has

  [[nodiscard]] std::int32_t smaller(std::int32_t p, std::int32_t q) const { return voxels[p] < voxels[q] ? p : q; }
};

LabelParts parts_of(std::span<const std::uint8_t> labels, std::span<const std::uint8_t> seeds, int regions,
                    const Grid& grid) {
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
  parts.voxels.assign(parts.labels.size(), 0);
  parts.seeded.assign(parts.labels.size(), false);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (parts.of_voxel[i] < 0) continue;
    ++parts.voxels[parts.of_voxel[i]];
    if (seeds[i] == labels[i] + 1) parts.seeded[parts.of_voxel[i]] = true;
  }
  return parts;
}

// Parts that no edge of the image divides.
class EdgelessParts {
 public:
  EdgelessParts(const Grid& grid, const SeededLabels& found)
      : grid_(grid), found_(found), labels_(found.labels.begin(), found.labels.end()) {
    for (std::size_t i = 0; i < found.mask.size(); ++i)
      if (found.mask[i] == 0) labels_[i] = no_label;
    for (const std::uint8_t label : labels_)
      if (label != no_label) regions_ = std::max(regions_, label + 1);
    parts_ = parts_of(labels_, found.seeds, regions_, grid);
    find_faces();
    measure_faces();
    find_pairs();
  }

  // A number for all parts that are joined; -1 for voxels of parts that stay as they are. Nothing where all do.
  [[nodiscard]] std::vector<std::int32_t> groups() const {
    DisjointSets sets(parts_.labels.size());
    for (const auto& [p, q] : pairs_) sets.unite(static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(q));
    if (pairs_.empty()) return {};
    std::vector<std::int32_t> of_part(parts_.labels.size(), -1);
    for (const auto& pair : pairs_)
      for (const std::int32_t part : pair)
        of_part[part] = static_cast<std::int32_t>(sets.find(static_cast<std::uint32_t>(part)));
    std::vector<std::int32_t> groups(labels_.size(), -1);
    for (std::size_t i = 0; i < groups.size(); ++i)
      if (parts_.of_voxel[i] >= 0) groups[i] = of_part[parts_.of_voxel[i]];
    return groups;
  }

 private:
  void find_faces() {
    const std::array<Index, 3> strides{1, grid_.size[0], grid_.size[0] * grid_.size[1]};
    for (Index i = 0; i < grid_.voxels(); ++i)
      for (int a = 0; a < grid_.dimension(); ++a) {
        const Index next = i + strides[a];
        if (i / strides[a] % grid_.size[a] + 1 == grid_.size[a] || labels_[i] == labels_[next]) continue;
        const std::int32_t p = parts_.of_voxel[i], q = parts_.of_voxel[next];
        if (p >= 0 && q >= 0 && parts_.seeded[parts_.smaller(p, q)]) faces_.push_back({{i, next}});
      }
  }

  // Means and numbers of the voxels of each side in the box around the voxel beside the border.
  void measure_faces() {
    std::array<Index, 3> half{0, 0, 0};
    const double edge = grid_.spacing.head(grid_.dimension()).minCoeff();
    double box = 1;
    for (int a = 0; a < grid_.dimension(); ++a) {
      half[a] = std::max<Index>(1, std::lround(close_by * edge / grid_.spacing[a]));
      box *= static_cast<double>(2 * half[a] + 1);
    }
    std::vector<float> sum(labels_.size()), share(labels_.size());
    for (int k = 0; k < regions_ && !faces_.empty(); ++k) {
      for (std::size_t i = 0; i < labels_.size(); ++i) {
        share[i] = labels_[i] == k ? 1.0F : 0.0F;
        sum[i] = labels_[i] == k ? found_.values[i] : 0.0F;
      }
      box_mean(sum, grid_.size, half);
      box_mean(share, grid_.size, half);
      for (SeedFace& face : faces_)
        for (std::size_t side = 0; side < 2; ++side) {
          const Index voxel = face.voxels[side];
          if (labels_[voxel] != k) continue;
          face.means[side] = static_cast<double>(sum[voxel]) / static_cast<double>(share[voxel]);
          face.counts[side] = std::min(most_counted, box * static_cast<double>(share[voxel]));
        }
    }
  }

  // What the second part of a pair is above the first, in deviations that chance gives.
  [[nodiscard]] double step_of(const SeedFace& face, const std::array<std::int32_t, 2>& pair) const {
    const double variance = found_.grain * (1 / face.counts[0] + 1 / face.counts[1]);
    const double step = (face.means[1] - face.means[0]) / (found_.deviation * std::sqrt(variance));
    return parts_.of_voxel[face.voxels[0]] == pair[0] ? step : -step;
  }

  // The smaller part of each pair, with that neighbour only with which it shares most of such a border.
  void find_pairs() {
    std::map<std::array<std::int32_t, 2>, std::vector<const SeedFace*>> borders;
    for (const SeedFace& face : faces_) {
      const std::int32_t p = parts_.of_voxel[face.voxels[0]], q = parts_.of_voxel[face.voxels[1]];
      borders[{std::min(p, q), std::max(p, q)}].push_back(&face);
    }
    std::map<std::int32_t, std::pair<Index, std::int32_t>> partners;  // faces, part
    for (const auto& [pair, faces] : borders) {
      double sides = 0;
      for (const SeedFace* face : faces) sides += step_of(*face, pair) > 0 ? 1 : -1;
      const double sign = sides < 0 ? -1 : 1;
      Index none = 0;
      for (const SeedFace* face : faces) none += sign * step_of(*face, pair) < chance ? 1 : 0;
      if (static_cast<double>(none) <= edgeless * static_cast<double>(faces.size())) continue;
      const std::int32_t small = parts_.smaller(pair[0], pair[1]), large = pair[0] + pair[1] - small;
      if (none > partners[small].first) partners[small] = {none, large};
    }
    for (const auto& [part, partner] : partners) pairs_.push_back({part, partner.second});
  }

  const Grid& grid_;
  const SeededLabels& found_;
  std::vector<std::uint8_t> labels_;
  int regions_ = 0;
  LabelParts parts_;
  std::vector<SeedFace> faces_;
  std::vector<std::array<std::int32_t, 2>> pairs_;
};

// What is known of labels with seeds.
struct SeededRegions {
  std::vector<double> means, counts;         // of the seeds, in deviations
  std::vector<std::vector<double>> squares;  // of what the mean of each region leaves of the seeds of each, on average
  LabelMeasures measures;
  double deviation = 0, grain = 1;  // of what the means leave of the image

  // Another region is more like the seeds than their own, as where that became the blurred border of both.
  [[nodiscard]] bool drifted(std::size_t own, std::size_t other) const {
    return squares[own][own] > squares[own][other] + 1;
  }
  [[nodiscard]] bool may_be_alike(std::size_t one, std::size_t other) const {
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
    if (seeds[i] != 0 && price.inside(i)) {
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
  const LabelParts parts = parts_of(masked, of_class, count, price.grid());
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

AlikeLabels divide_by_seeds(const Grid& grid, const SeededLabels& found) {
  const std::vector<std::uint8_t> before(found.labels.begin(), found.labels.end());
  const std::vector<std::int32_t> groups = EdgelessParts(grid, found).groups();
  AlikeLabels alike;
  if (groups.empty()) return alike;
  const std::set<std::int32_t> open = nearest_seeds(grid, groups, found.seeds, found.labels);
  std::map<std::int32_t, std::set<int>> labels_in;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const int one = before[i], other = found.labels[i];
    if (one != other) alike.divided.insert({std::min(one, other), std::max(one, other)});
    if (open.contains(groups[i]) && found.seeds[i] != 0) labels_in[groups[i]].insert(found.seeds[i] - 1);
  }
  for (const auto& [group, labels] : labels_in) add_pairs(labels, alike.open);
  return alike;
}

AlikeLabels divide_by_seeds(PartitionPrice& price, const SeedCosts& seeds, int regions, Partition& found) {
  if (seeds.labels.empty()) return {};
  std::vector<std::uint8_t> certain(seeds.labels.begin(), seeds.labels.end());
  for (std::size_t i = 0; i < certain.size(); ++i)
    if (!seeds.is_certain(i)) certain[i] = 0;
  price.fit(found.labels, found.model, regions);
  const std::vector<float> rest = price.rest(found.labels);
  double squares = 0;
  for (const float each : rest) squares += static_cast<double>(each) * static_cast<double>(each);
  const double deviation = std::sqrt(squares / price.voxels()) + price.least_deviation();
  const double grain = std::max(price.grain(), noise_grain(rest, price.grid(), price.mask()));
  AlikeLabels alike;
  if (regions > 2) {
    const std::vector<std::uint8_t> classes =
        label_classes(price, measure_seeded(price, certain, regions, found, deviation, grain), found);
    const int count = *std::max_element(classes.begin(), classes.end()) + 1;
    if (count >= 2 && count < regions) alike = divide_classes(price, seeds, certain, classes, found);
  }
  // Seeds of the background in what is like an organ.
  AlikeLabels more =
      divide_by_seeds(price.grid(), {price.values(), deviation, grain, price.mask(), certain, found.labels});
  alike.divided.merge(more.divided);
  alike.open.merge(more.open);
  return alike;
}

}  // namespace csrbf
