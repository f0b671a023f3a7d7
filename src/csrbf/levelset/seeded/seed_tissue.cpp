#include "csrbf/levelset/seeded/seed_tissue.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "csrbf/levelset/image/signed_distance.hpp"
#include "csrbf/levelset/partition/region_moments.hpp"
#include "csrbf/levelset/regions/region_labels.hpp"
#include "csrbf/levelset/seeded/necks.hpp"
#include "csrbf/levelset/seeded/value_classes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace csrbf {
namespace {

// By hand.
constexpr std::array<double, 4> tissue_scales{0.7, 1, 1.5, 2.2};  // of the blur, in voxels of the shortest edge
constexpr double edge_step = 5;        // deviations of the noise by which neighbours differ at an edge
constexpr double class_share = 0.2;    // of the seed, for a class to be one of its own
constexpr double class_reach = 6;      // deviations of a class from its median
constexpr double most_uneven = 1.3;    // deviations of a tissue over those of its noise
constexpr double least_apart = 1.5;    // deviations of a tissue to the next class
constexpr double most_of_image = 0.6;  // share of the mask that a tissue may have
constexpr std::size_t class_bins = 128;

// The tissue on one scale.
struct ScaledTissue {
  std::vector<std::uint8_t> labels;
  double uneven = std::numeric_limits<double>::infinity();  // its deviation over that of its noise
  double uneven_about_trend = 0;                            // what a linear trend leaves of it
  double apart = 0;                                         // from the next class, in its deviations
  double share = 1;                                         // of the mask
  Index classes = 1;                                        // of the image
  double mean = 0, deviation = 0;
};

class TissueFinder {
 public:
  TissueFinder(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask,
               std::span<const std::uint8_t> seed, bool fill, std::span<const std::uint8_t> seeds,
               std::span<const std::uint8_t> far)
      : values_(values),
        grid_(grid),
        mask_(mask),
        edge_(grid.spacing.head(grid.dimension()).minCoeff()),
        fill_(fill),
        seeds_(seeds),
        far_(far) {
    seed_.assign(seed.begin(), seed.end());
    for (std::size_t i = 0; i < seed_.size(); ++i) seed_[i] = seed_[i] != 0 && inside(i) ? 1 : 0;
    wide_seed_ = seed_;
    constexpr Index few = 20;  // voxels: one or two around them count, too
    if (std::count(seed_.begin(), seed_.end(), 1) < few) {
      const std::vector<float> depth = signed_distance(grid, seed_.data());
      const double reach = (grid.dimension() == 3 ? 0.6 : 1.6) * edge_;
      for (std::size_t i = 0; i < seed_.size(); ++i)
        if (static_cast<double>(depth[i]) > -reach && inside(i)) wide_seed_[i] = 1;
    }
    noise_ = find_noise();
  }

  std::optional<SeedTissue> find() {
    std::optional<ScaledTissue> best;
    double least = std::numeric_limits<double>::infinity();
    bool even = false;
    for (const double scale : tissue_scales) {
      ScaledTissue found = at_scale(scale);
      if (best && found.classes < 2) break;  // blurred into what is around
      if (found.classes < 2 || found.share > most_of_image) continue;
      even = found.uneven < most_uneven && found.apart > least_apart;
      const double penalty = found.uneven * std::sqrt(scale);
      if (even || penalty < least) {
        best = std::move(found);
        least = penalty;
      }
      if (even) break;
    }
    if (!best) return std::nullopt;
    SeedTissue tissue{smooth(best->labels), even || best->uneven_about_trend < most_uneven, 0, noise_,
                      best->classes == 2 && is_noisy(best->labels)};
    tissue.neck = cut_necks(tissue.labels, seed_, grid_);
    if (fill_) fill_enclosed(tissue.labels, grid_, seeds_);
    return tissue;
  }

 private:
  [[nodiscard]] bool inside(std::size_t i) const { return mask_.empty() || mask_[i] != 0; }
  [[nodiscard]] bool far(std::size_t i) const { return !far_.empty() && far_[i] != 0; }

  [[nodiscard]] std::array<double, 3> deviations(double scale) const {
    std::array<double, 3> sd{0, 0, 0};
    for (int a = 0; a < grid_.dimension(); ++a) sd[a] = scale * edge_ / grid_.spacing[a];
    return sd;
  }

  // What remains of the variance of independent noise.
  [[nodiscard]] double remaining(double scale) const {
    double share = 1;
    for (const double sd : deviations(scale)) share /= std::max(1.0, 2 * std::sqrt(std::numbers::pi) * sd);
    return share;
  }

  // By second differences along all axes, of the image or of what is near the seed, where it may be more.
  [[nodiscard]] double find_noise() const {
    constexpr std::size_t most = 200'000, few = 50;  // differences; more say nothing new
    constexpr double near = 3;                       // voxels of the shortest edge
    std::vector<double> all, of_seed;
    const std::vector<float> depth = signed_distance(grid_, seed_.data());
    const std::array<Index, 3> strides{1, grid_.size[0], grid_.size[0] * grid_.size[1]};
    const std::size_t step = std::max<std::size_t>(1, values_.size() / most) | 1U;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const bool at_seed = static_cast<double>(depth[i]) > -near * edge_;
      if (i % step != 0 && !at_seed) continue;
      for (int a = 0; a < grid_.dimension(); ++a) {
        const Index at = static_cast<Index>(i) / strides[a] % grid_.size[a];
        if (at == 0 || at + 1 >= grid_.size[a]) continue;
        const auto stride = static_cast<std::size_t>(strides[a]);
        if (!inside(i) || !inside(i - stride) || !inside(i + stride)) continue;
        const auto difference =
            static_cast<double>(std::abs(values_[i - stride] - 2 * values_[i] + values_[i + stride]));
        if (i % step == 0) all.push_back(difference);
        if (at_seed) of_seed.push_back(difference);
      }
    }
    const double typical = all.empty() ? 0 : median(all);
    return (of_seed.size() < few ? typical : std::max(typical, median(of_seed))) / (median_of_normal * std::sqrt(6.0));
  }

  // The mean near each voxel of the values where `here` is 1.
  [[nodiscard]] std::vector<float> blurred(std::span<const float> values, std::span<const std::uint8_t> here,
                                           double scale) const {
    std::vector<float> sums(values.begin(), values.end());
    if (here.empty()) {
      gaussian_blur(sums, grid_.size, deviations(scale));
      return sums;
    }
    std::vector<float> shares(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      shares[i] = here[i] != 0 ? 1.0F : 0.0F;
      if (here[i] == 0) sums[i] = 0;
    }
    gaussian_blur(sums, grid_.size, deviations(scale));
    gaussian_blur(shares, grid_.size, deviations(scale));
    for (std::size_t i = 0; i < values.size(); ++i) sums[i] = shares[i] > 0 ? sums[i] / shares[i] : 0.0F;
    return sums;
  }

  // The least or the largest value of the 3 x 3 (x 3) voxels in the mask around each.
  template <class Better>
  [[nodiscard]] std::vector<float> extremes(std::span<const float> values, float worst, const Better& better) const {
    std::vector<float> result(values.begin(), values.end());
    for (std::size_t i = 0; i < result.size(); ++i)
      if (!inside(i)) result[i] = worst;
    const std::array<Index, 3> strides{1, grid_.size[0], grid_.size[0] * grid_.size[1]};
    for (int a = 0; a < grid_.dimension(); ++a) {
      const std::vector<float> before = result;
      parallel_for(grid_.voxels(), 1 << 14, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
          const Index at = i / strides[a] % grid_.size[a];
          if (at > 0) result[i] = better(result[i], before[i - strides[a]]);
          if (at + 1 < grid_.size[a]) result[i] = better(result[i], before[i + strides[a]]);
        }
      });
    }
    return result;
  }

  [[nodiscard]] std::vector<float> minima(std::span<const float> values) const {
    return extremes(values, std::numeric_limits<float>::max(), [](float a, float b) { return std::min(a, b); });
  }
  [[nodiscard]] std::vector<float> maxima(std::span<const float> values) const {
    return extremes(values, std::numeric_limits<float>::lowest(), [](float a, float b) { return std::max(a, b); });
  }

  // At edges every voxel takes the value of the side that is closer to its own. Returns where there are some still.
  std::vector<std::uint8_t> sharpen(std::vector<float>& values, double step) const {
    constexpr int rounds = 2;
    std::vector<std::uint8_t> edges(values.size(), 0);
    for (int round = 0; round <= rounds; ++round) {
      const std::vector<float> lo = minima(values), hi = maxima(values);
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (!inside(i)) continue;
        const bool edge = static_cast<double>(hi[i] - lo[i]) > step;
        if (round == rounds)
          edges[i] = edge ? 1 : 0;
        else if (edge)
          values[i] = hi[i] - values[i] < values[i] - lo[i] ? hi[i] : lo[i];
      }
    }
    return edges;
  }

  // The voxels of the tissue, not of its rim, but where that is all.
  [[nodiscard]] std::vector<std::uint8_t> core_of(std::span<const std::uint8_t> labels) const {
    constexpr Index few = 30;
    const std::vector<float> depth = signed_distance(grid_, labels.data());
    std::vector<std::uint8_t> core(labels.size());
    for (std::size_t i = 0; i < labels.size(); ++i) core[i] = static_cast<double>(depth[i]) > edge_ ? 1 : 0;
    return std::count(core.begin(), core.end(), 1) > few ? core
                                                         : std::vector<std::uint8_t>(labels.begin(), labels.end());
  }

  [[nodiscard]] static std::vector<double> taken(std::span<const float> values, std::span<const std::uint8_t> from) {
    std::vector<double> some;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (from[i] != 0) some.push_back(static_cast<double>(values[i]));
    return some;
  }

  ScaledTissue at_scale(double scale) const {
    const std::vector<float> blur = blurred(values_, mask_, scale);
    std::vector<float> sharp = blur;
    const double noise = noise_ * std::sqrt(remaining(scale));
    const std::vector<std::uint8_t> edges = sharpen(sharp, edge_step * noise);
    const Bins bins = bins_of(sharp);
    std::vector<double> histogram(class_bins, 0);
    constexpr double edge_weight = 0.05;
    for (std::size_t i = 0; i < sharp.size(); ++i)
      if (inside(i)) histogram[bins.at(sharp[i])] += edges[i] != 0 ? edge_weight : 1;
    const std::vector<std::size_t> starts = value_classes(histogram, remaining(scale));
    const auto [first, last] = classes_of_seed(sharp, bins, starts);
    ScaledTissue found;
    found.classes = std::ssize(starts) - 1;
    std::vector<std::uint8_t> like(sharp.size());
    for (std::size_t i = 0; i < sharp.size(); ++i) {
      const std::size_t bin = bins.at(sharp[i]);
      like[i] = inside(i) && !far(i) && bin >= starts[first] && bin < starts[last + 1] ? 1 : 0;
    }
    found.labels = marked_parts(like, seed_, grid_);
    std::vector<double> some = taken(sharp, core_of(found.labels));
    if (some.size() < 3) {
      found.classes = 1;
      return found;
    }
    const double middle = median(some);
    for (double& each : some) each = std::abs(each - middle);
    const double reach = class_reach * std::max({median(some) / median_of_normal, 0.25 * noise, 0.5 * bins.width});
    for (std::size_t i = 0; i < sharp.size(); ++i)
      if (std::abs(static_cast<double>(sharp[i]) - middle) > reach && wide_seed_[i] == 0) like[i] = 0;
    found.labels = marked_parts(like, seed_, grid_);
    if (!holds_seed(found.labels, sharp, middle, reach)) {
      found.classes = 1;
      return found;
    }
    judge(found, blur, scale);
    const double below = first > 0 ? bins.lo + bins.width * static_cast<double>(starts[first]) : -infinite;
    const double above =
        last + 2 < starts.size() ? bins.lo + bins.width * static_cast<double>(starts[last + 1]) : infinite;
    found.apart = std::min(found.mean - below, above - found.mean) / std::max(found.deviation, 1e-30);
    return found;
  }

  // Whether most of the seed, or of the voxels around a small one, lies in it, and some of that has values of its own:
  // else it is the seed alone, or what is around.
  [[nodiscard]] bool holds_seed(std::span<const std::uint8_t> labels, std::span<const float> values, double middle,
                                double reach) const {
    double all = 0, held = 0, alike = 0;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (wide_seed_[i] == 0) continue;
      ++all;
      if (labels[i] == 0) continue;
      ++held;
      alike += std::abs(static_cast<double>(values[i]) - middle) <= reach ? 1 : 0;
    }
    return held >= 0.5 * all && alike >= class_share * all;
  }

  struct Bins {
    double lo = 0, width = 1;
    [[nodiscard]] std::size_t at(float value) const {
      const double bin = (static_cast<double>(value) - lo) / width;
      return static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(class_bins - 1)));
    }
  };

  // Over all but a few extremes, and the seed.
  [[nodiscard]] Bins bins_of(std::span<const float> values) const {
    constexpr double few = 0.001, more = 0.1;
    std::vector<double> all;
    all.reserve(values.size());
    double seed_lo = infinite, seed_hi = -infinite;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!inside(i)) continue;
      const auto value = static_cast<double>(values[i]);
      all.push_back(value);
      if (wide_seed_[i] == 0) continue;
      seed_lo = std::min(seed_lo, value);
      seed_hi = std::max(seed_hi, value);
    }
    const double least = *std::min_element(all.begin(), all.end()), most = *std::max_element(all.begin(), all.end());
    const double lo = percentile(all, few), hi = percentile(all, 1 - few), beyond = more * (hi - lo);
    Bins bins;
    bins.lo = std::min(seed_lo, std::max(least, lo - beyond));
    const double end = std::max(seed_hi, std::min(most, hi + beyond));
    bins.width = std::max((end - bins.lo) / static_cast<double>(class_bins), 1e-30);
    return bins;
  }

  // The first and the last of those that hold some of the seed.
  [[nodiscard]] std::array<std::size_t, 2> classes_of_seed(std::span<const float> values, const Bins& bins,
                                                           std::span<const std::size_t> starts) const {
    std::vector<double> counts(starts.size() - 1, 0);
    double all = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (wide_seed_[i] == 0) continue;
      const auto next = std::upper_bound(starts.begin(), starts.end() - 1, bins.at(values[i]));
      ++counts[static_cast<std::size_t>(next - starts.begin()) - 1];
      ++all;
    }
    const auto most = std::max_element(counts.begin(), counts.end());
    std::array<std::size_t, 2> ends{};
    ends.fill(static_cast<std::size_t>(most - counts.begin()));
    for (std::size_t k = 0; k < counts.size(); ++k)
      if (counts[k] >= class_share * all) ends = {std::min(ends[0], k), std::max(ends[1], k)};
    return ends;
  }

  // How much the tissue varies, and how much of that is noise: what its mean near each voxel leaves. A trend may be two
  // tissues side by side, so it counts as such only where no scale does without.
  void judge(ScaledTissue& found, std::span<const float> blur, double scale) const {
    const double near = 2 * scale;
    const std::vector<float> local = blurred(blur, found.labels, near);
    const std::vector<std::uint8_t> core = core_of(found.labels);
    const RegionMoments moments = region_moments(blur, core, 1, grid_);
    const double count = std::max(1.0, moments.count()), trend = MeanPolynomial(moments, 1, grid_).residual(moments);
    double rest = 0, voxels = 0, size = 0;
    for (std::size_t i = 0; i < blur.size(); ++i) {
      voxels += inside(i) ? 1 : 0;
      size += found.labels[i];
      if (core[i] != 0) rest += std::pow(static_cast<double>(blur[i] - local[i]), 2);
    }
    found.share = size / std::max(1.0, voxels);
    found.mean = moments.mean();
    found.deviation = std::sqrt(std::max(0.0, moments.squares / count - found.mean * found.mean));
    const double all = remaining(scale), twice = remaining(std::sqrt(scale * scale + near * near));
    const double kept = all + twice - 2 * remaining(std::sqrt(scale * scale + 0.5 * near * near));
    const double noise = std::sqrt(rest / count * all / std::max(kept, 1e-12));
    const double least = 1e-12 * std::abs(found.mean) + 1e-30;
    found.uneven = found.deviation / std::max(noise, least);
    found.uneven_about_trend = std::sqrt(std::max(0.0, trend) / count) / std::max(noise, least);
  }

  // Whether single voxels hardly tell the inside from the rest.
  [[nodiscard]] bool is_noisy(std::span<const std::uint8_t> labels) const {
    constexpr double clear = 1.5;  // deviations of the noise between the means; by hand
    std::array<double, 2> counts{0, 0}, sums{0, 0};
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (!inside(i)) continue;
      ++counts[labels[i]];
      sums[labels[i]] += static_cast<double>(values_[i]);
    }
    return std::abs(sums[1] / std::max(1.0, counts[1]) - sums[0] / std::max(1.0, counts[0])) < clear * noise_;
  }

  // By majority near each voxel: single voxels are noise.
  [[nodiscard]] std::vector<std::uint8_t> smooth(std::span<const std::uint8_t> labels) const {
    std::vector<float> share(labels.size());
    std::transform(labels.begin(), labels.end(), share.begin(),
                   [](std::uint8_t label) { return label != 0 ? 1.0F : 0.0F; });
    gaussian_blur(share, grid_.size, deviations(tissue_scales[0]));
    std::vector<std::uint8_t> most(labels.size());
    for (std::size_t i = 0; i < labels.size(); ++i) most[i] = inside(i) && (share[i] > 0.5F || seed_[i] != 0) ? 1 : 0;
    most = marked_parts(most, seed_, grid_);
    if (fill_) fill_enclosed(most, grid_, seeds_);
    return most;
  }

  static constexpr double infinite = std::numeric_limits<double>::infinity();
  std::span<const float> values_;
  const Grid& grid_;
  std::span<const std::uint8_t> mask_;
  double edge_ = 1, noise_ = 0;
  std::vector<std::uint8_t> seed_, wide_seed_;
  bool fill_;
  std::span<const std::uint8_t> seeds_, far_;
};

}  // namespace

std::optional<SeedTissue> find_seed_tissue(std::span<const float> values, const Grid& grid,
                                           std::span<const std::uint8_t> mask, std::span<const std::uint8_t> seed,
                                           bool fill, std::span<const std::uint8_t> seeds,
                                           std::span<const std::uint8_t> far) {
  bool any = false;
  for (std::size_t i = 0; i < seed.size() && !any; ++i) any = seed[i] != 0 && (mask.empty() || mask[i] != 0);
  if (!any) return std::nullopt;
  return TissueFinder(values, grid, mask, seed, fill, seeds, far).find();
}

}  // namespace csrbf
