#include "csrbf/levelset/disturbances/region_levels.hpp"

#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "csrbf/levelset/image/signed_distance.hpp"
#include "csrbf/levelset/partition/region_moments.hpp"
#include "csrbf/levelset/regions/intensity_classes.hpp"
#include "csrbf/levelset/regions/label_runs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

namespace csrbf {
namespace {

constexpr double border = 2;            // voxels beside the other region that its blur may change; by hand
constexpr double blur = 1.5;            // deviation of the Gaussian before classes, in voxels; 1 and 2 find the same
constexpr double apart = 3;             // voxels farther than which noise is independent; by hand
constexpr Index most_levels = 3;        // of a region
constexpr Index least_voxels = 30;      // of a level
constexpr double least_contrast = 0.3;  // of that of the two regions; by hand: rims of blurred borders have up to 0.3
// Deviation of what varies within a level, of the contrast of levels: 0.29 where a region has all levels between two;
// by hand: nuclei and histology leave 0.15 and more, levels mostly below 0.1.
constexpr double most_structure = 0.14;

constexpr double least_resolved = 1e-3;  // of that contrast: what is left of images without noise

constexpr std::uint8_t none = 255;  // voxels that do not count

// Levels of intensity that a region consists of.
struct RegionLevels {
  std::vector<double> means;  // two or three, ascending
  double nats = 0;            // that describing each level by its own mean saves
};

// Sums over the pairs of voxels of one level.
struct LevelSums {
  double sum = 0, count = 0, squares = 0;
  double products = 0, pairs = 0;  // of what the mean leaves, `apart` from each other
};

class Levels {
 public:
  // `values`: in units of the contrast of the two regions.
  Levels(std::vector<float> values, const Grid& grid, const LevelPrice& price, std::vector<std::uint8_t> region)
      : values_(std::move(values)), grid_(grid), price_(price), region_(std::move(region)) {
    const RegionMoments moments = region_moments(values_, region_, 0, grid_);
    count_ = moments.count();
    if (count_ < 2 * static_cast<double>(least_voxels)) return;
    one_ = std::min(MeanPolynomial(moments, 0, grid_).residual(moments),
                    MeanPolynomial(moments, 2, grid_).residual(moments));
    blur_values();
  }

  [[nodiscard]] std::optional<RegionLevels> find() {
    std::optional<RegionLevels> best;
    for (Index n = 2; n <= most_levels && filled_ >= n; ++n) {
      const std::vector<double> thresholds = optimal_classes(histogram_, n).thresholds;
      std::vector<std::uint8_t> labels = region_;
      for (std::size_t i = 0; i < labels.size(); ++i)
        if (region_[i] == 0)
          labels[i] = static_cast<std::uint8_t>(
              std::upper_bound(thresholds.begin(), thresholds.end(), static_cast<double>(smooth_[i])) -
              thresholds.begin());
      std::optional<RegionLevels> found = measure(labels, n);
      if (found && (!best || found->nats > best->nats)) best = std::move(found);
    }
    return best;
  }

 private:
  // Of the voxels of the region alone.
  void blur_values() {
    std::array<double, 3> along{0, 0, 0};
    for (std::size_t a = 0; a < 3; ++a) along[a] = blur * price_.weight.along[a];
    std::vector<float> share(values_.size());
    smooth_.resize(values_.size());
    for (std::size_t i = 0; i < values_.size(); ++i) {
      share[i] = region_[i] == 0 ? 1.0F : 0.0F;
      smooth_[i] = region_[i] == 0 ? values_[i] : 0.0F;
    }
    gaussian_blur(smooth_, grid_.size, along);
    gaussian_blur(share, grid_.size, along);
    float lo = std::numeric_limits<float>::infinity(), hi = -lo;
    for (std::size_t i = 0; i < smooth_.size(); ++i) {
      if (region_[i] != 0) continue;
      smooth_[i] /= share[i];
      lo = std::min(lo, smooth_[i]);
      hi = std::max(hi, smooth_[i]);
    }
    if (!(hi > lo)) return;
    histogram_ = Histogram({static_cast<double>(lo), static_cast<double>(hi), 256});
    for (std::size_t i = 0; i < smooth_.size(); ++i)
      if (region_[i] == 0) histogram_.add(static_cast<double>(smooth_[i]));
    filled_ = std::count_if(histogram_.counts.begin(), histogram_.counts.end(), [](double n) { return n > 0; });
  }

  std::optional<RegionLevels> measure(std::span<const std::uint8_t> labels, Index n) const {
    std::vector<LevelSums> levels(static_cast<std::size_t>(n));
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (labels[i] == none) continue;
      levels[labels[i]].sum += static_cast<double>(values_[i]);
      levels[labels[i]].count += 1;
    }
    RegionLevels result;
    for (const LevelSums& level : levels) {
      if (level.count < static_cast<double>(least_voxels)) return std::nullopt;
      result.means.push_back(level.sum / level.count);
    }
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 1; k < result.means.size(); ++k)
      least = std::min(least, result.means[k] - result.means[k - 1]);
    if (!(least > least_contrast)) return std::nullopt;
    const double contour = add_pairs(labels, result.means, levels);
    double squares = 0;
    for (const LevelSums& level : levels) {
      if (level.products > std::pow(most_structure * least, 2) * level.pairs) return std::nullopt;
      squares += level.squares;
    }
    const double resolved = std::pow(least_resolved, 2) * count_;
    LabelRuns runs(labels, grid_);
    double parts = 0;
    for (Index k = 0; k < n; ++k) parts += static_cast<double>(runs.parts(static_cast<std::uint8_t>(k)).count);
    result.nats = 0.5 * count_ / price_.grain * std::log((one_ + resolved) / (squares + resolved)) - contour -
                  parts * std::log(std::max(1.0, count_ / price_.grain));
    return result.nats > 0 ? std::optional(result) : std::nullopt;
  }

  // Squares and products of what the means leave; returns the price of the contours between levels.
  double add_pairs(std::span<const std::uint8_t> labels, const std::vector<double>& means,
                   std::vector<LevelSums>& levels) const {
    const auto left = [&](std::size_t i) { return static_cast<double>(values_[i]) - means[labels[i]]; };
    double edges = 0;
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (labels[i] != none) levels[labels[i]].squares += left(i) * left(i);
    Index stride = 1;
    for (std::size_t a = 0; a < 3; stride *= grid_.size[a], ++a) {
      const double along = price_.weight.along[a];
      const Index lag = std::max<Index>(1, std::lround(apart * along));
      for (Index i = 0; i + stride < grid_.voxels(); ++i) {
        const Index place = i / stride % grid_.size[a];
        const std::uint8_t here = labels[i];
        if (here == none || place + 1 >= grid_.size[a]) continue;
        const std::uint8_t next = labels[i + stride];
        if (next != none && next != here) edges += along;
        if (place + lag >= grid_.size[a] || labels[i + lag * stride] != here) continue;
        levels[here].products += left(i) * left(i + lag * stride);
        levels[here].pairs += 1;
      }
    }
    return edges * price_.weight.length;
  }

  std::vector<float> values_;
  const Grid& grid_;
  const LevelPrice& price_;
  std::vector<std::uint8_t> region_;  // 0 in it
  std::vector<float> smooth_;
  Histogram histogram_;
  Index filled_ = 0;  // bins
  double count_ = 0, one_ = 0;
};

std::array<double, 2> means_of(std::span<const float> values, std::span<const std::uint8_t> labels,
                               std::span<const std::uint8_t> mask) {
  std::array<double, 2> sums{0, 0}, counts{0, 0};
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!mask.empty() && mask[i] == 0) continue;
    sums[labels[i]] += static_cast<double>(values[i]);
    counts[labels[i]] += 1;
  }
  return {sums[0] / counts[0], sums[1] / counts[1]};
}

// Levels of both regions; one of either that is as close to one of the other as no two of a region are is the same.
Index count_levels(const std::vector<double>& one, const std::vector<double>& other, double contrast) {
  const auto is_new = [&](double mean) {
    return std::none_of(one.begin(), one.end(),
                        [&](double each) { return std::abs(each - mean) <= least_contrast * contrast; });
  };
  return std::ssize(one) + std::count_if(other.begin(), other.end(), is_new);
}

// Significant digits that tell the levels apart, and that their integer parts have.
int digits_of(const std::vector<double>& means) {
  constexpr int fewest = 3, most_of_integers = 7, most = 15;
  double largest = 0, distance = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < means.size(); ++k) {
    largest = std::max(largest, std::abs(means[k]));
    if (k > 0) distance = std::min(distance, means[k] - means[k - 1]);
  }
  const int integers = std::min(most_of_integers, 1 + static_cast<int>(std::floor(std::log10(largest))));
  return std::clamp(std::max(integers, 2 + static_cast<int>(std::ceil(std::log10(largest / distance)))), fewest, most);
}

}  // namespace

void warn_of_levels(std::span<const float> values, std::span<const std::uint8_t> labels, const Grid& grid,
                    std::span<const std::uint8_t> mask, const LevelPrice& price, std::vector<std::string>& warnings) {
  const std::array<double, 2> means = means_of(values, labels, mask);
  const double contrast = std::abs(means[1] - means[0]);
  if (!(contrast > 0)) return;
  const std::vector<float> distance = signed_distance(grid, labels.data());
  const double edge = grid.spacing.head(grid.dimension()).minCoeff(), least = (border - 0.5) * edge;
  const auto find = [&](int label, double mean) {
    std::vector<std::uint8_t> region(labels.size());
    std::vector<float> scaled(labels.size());
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const bool inside = mask.empty() || mask[i] != 0;
      const double depth = static_cast<double>(label == 1 ? distance[i] : -distance[i]);
      region[i] = inside && depth > least ? 0 : none;
      scaled[i] = inside ? static_cast<float>((static_cast<double>(values[i]) - mean) / contrast) : 0.0F;
    }
    return Levels(std::move(scaled), grid, price, std::move(region)).find();
  };
  std::array<std::vector<double>, 2> levels;
  double nats = 0;
  std::ostringstream text;
  for (const int label : {0, 1}) {
    const auto k = static_cast<std::size_t>(label);
    levels[k] = {means[k]};
    const std::optional<RegionLevels> found = find(label, means[k]);
    if (!found) continue;
    levels[k].clear();
    for (const double each : found->means) levels[k].push_back(means[k] + contrast * each);
    text.precision(digits_of(levels[k]));
    text << (nats > 0 ? ", label " : "label ") << label << " has levels of";
    for (std::size_t i = 0; i < levels[k].size(); ++i) text << (i > 0 ? " and " : " ") << levels[k][i];
    nats += found->nats;
  }
  const Index count = count_levels(levels[0], levels[1], contrast);
  if (!(nats > 0) || count < 3) return;
  text << "; to tell them apart, which describes the image in " << std::lround(nats) << " nats less, give " << count
       << " as the number of regions";
  warnings.push_back("more than two levels: " + text.str());
}

}  // namespace csrbf
