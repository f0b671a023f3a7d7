#include "csrbf/levelset/regions/intensity_histogram.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/core/simd.hpp"

#include <mutex>
#include <numeric>

namespace csrbf {
namespace {

constexpr Index most_bins = 256;  // an index is one byte
constexpr Index grain = 1 << 18;  // voxels per task: many for each copy of the counts

void require_bins(const char* function, const IntensityBins& bins) {
  require(bins.count >= 1 && bins.count <= most_bins, function, "bins.count", bins.count, "must be 1 to 256");
  require(bins.hi > bins.lo && std::isfinite(bins.hi - bins.lo), function, "bins.hi - bins.lo", bins.hi - bins.lo,
          "must be positive and finite");
}

struct ValueRange {
  float lo = std::numeric_limits<float>::infinity();
  float hi = -std::numeric_limits<float>::infinity();
  bool integers = true;
  bool finite = true;
  Index voxels = 0;

  void add(float value) {
    lo = std::min(lo, value);
    hi = std::max(hi, value);
    integers = integers && value == std::nearbyint(value);
    finite = finite && std::abs(value) <= std::numeric_limits<float>::max();
    ++voxels;
  }
  void add(const ValueRange& other) {
    lo = std::min(lo, other.lo);
    hi = std::max(hi, other.hi);
    integers = integers && other.integers;
    finite = finite && other.finite;
    voxels += other.voxels;
  }
};

ValueRange range_of(std::span<const float> values, std::span<const std::uint8_t> mask) {
  ValueRange range;
  std::mutex mutex;  // least and greatest do not depend on the order
  parallel_for(std::ssize(values), grain, [&](Index begin, Index end) {
    ValueRange part;
    for (Index i = begin; i < end; ++i)
      if (mask.empty() || mask[i] != 0) part.add(values[i]);
    const std::lock_guard lock(mutex);
    range.add(part);
  });
  return range;
}

// Narrows the range where a few values lie far outside of all others.
void exclude_outliers(std::span<const float> values, std::span<const std::uint8_t> mask, double& lo, double& hi) {
  constexpr Index most_samples = 1 << 14;  // 16 of them in each tail
  constexpr double tail = .001;            // share of the voxels at each end that may be outliers; by hand
  constexpr double reach = 3;         // ranges of the others that bins extend beyond them; by hand: less clips tails
  constexpr double far = reach + .5;  // outliers nearer than that would make bins hardly smaller
  const auto step = static_cast<std::size_t>(1 + std::ssize(values) / most_samples);
  std::vector<float> samples;
  for (std::size_t i = 0; i < values.size(); i += step)
    if (mask.empty() || mask[i] != 0) samples.push_back(values[i]);
  if (samples.empty()) return;
  const auto outside = static_cast<std::ptrdiff_t>(tail * static_cast<double>(samples.size()));
  const auto low = static_cast<double>(order_statistic(samples, outside));
  const auto high = static_cast<double>(order_statistic(samples, std::ssize(samples) - 1 - outside));
  const double R = high - low;
  if (R <= 0) return;
  if (lo < low - far * R) lo = low - reach * R;
  if (hi > high + far * R) hi = high + reach * R;
}

struct Levels {
  double first = 0, distance = 0;  // 0: there are none
};

// The levels of counts and the like, of some of the values: all are multiples of a distance apart, but for those at the
// ends, which may be clipped, and for what is rounded to integers, and most occur more than once. None in drawings of
// few values, which are exact.
Levels find_levels(std::span<const float> values, std::span<const std::uint8_t> mask, bool integers) {
  constexpr Index most_samples = 1 << 14;
  const auto step = static_cast<std::size_t>(1 + std::ssize(values) / most_samples);
  std::vector<float> samples;
  for (std::size_t i = 0; i < values.size(); i += step)
    if (mask.empty() || mask[i] != 0) samples.push_back(values[i]);
  const std::size_t sampled = samples.size();
  std::sort(samples.begin(), samples.end());
  samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
  constexpr std::size_t fewest_levels = 5;  // of counts: by hand
  if (samples.size() < fewest_levels || 4 * samples.size() > sampled) return {};
  const auto level = [&](std::size_t i) { return static_cast<double>(samples[i]); };
  const std::size_t last = samples.size() - 2;
  double distance = level(2) - level(1);
  for (std::size_t i = 2; i < last; ++i) distance = std::min(distance, level(i + 1) - level(i));
  constexpr double rounded = 0.1, to_integers = 0.25;  // of the distance: by hand
  for (std::size_t i = 2; i <= last; ++i) {
    const double off = level(i) - level(1), steps = std::round(off / distance);
    const double allowed = std::max(rounded * distance, integers ? std::min(1.0, to_integers * distance) : 0);
    if (std::abs(off - steps * distance) > allowed) return {};
    distance = off / steps;  // better known over the whole range
  }
  return {level(1), distance};
}

// As IntensityBins::index, bit for bit.
CSRBF_ALWAYS_INLINE void write_indices(const float* values, Index n, const IntensityBins& bins, std::uint8_t* indices) {
  const double lo = bins.lo;
  const double scale = static_cast<double>(bins.count) / (bins.hi - bins.lo);
  const auto last = static_cast<double>(bins.count - 1);
  for (Index i = 0; i < n; ++i) {
    double position = (static_cast<double>(values[i]) - lo) * scale;
    position = position > 0 ? position : 0;
    indices[i] = static_cast<std::uint8_t>(static_cast<int>(position < last ? position : last));
  }
}

// Counts of bin and region together, most_bins of them for each region and for the voxels of none. Neighbouring voxels
// are counted in different copies: most of them fall into one bin, and an increment would wait for the one before.
class RegionCounts {
 public:
  explicit RegionCounts(Index regions)
      : regions_(static_cast<std::uint32_t>(regions)), counts_(static_cast<std::size_t>(copies) * copy_size()) {}

  void count(const std::uint8_t* indices, const std::uint8_t* labels, Index n) {
    const std::size_t size = copy_size();
    std::uint32_t* counts = counts_.data();
    const auto slot = [&](Index i) {
      const std::uint32_t region = labels == nullptr ? 0 : std::min<std::uint32_t>(labels[i], regions_);
      return region * most_bins + indices[i];
    };
    Index i = 0;
    for (; i + copies <= n; i += copies)
      for (Index c = 0; c < copies; ++c) ++counts[static_cast<std::size_t>(c) * size + slot(i + c)];
    for (; i < n; ++i) ++counts[slot(i)];
  }

  void add_to(std::vector<std::int64_t>& sums) const {
    const std::size_t size = copy_size();
    for (std::size_t c = 0; c < static_cast<std::size_t>(copies); ++c)
      for (std::size_t k = 0; k < size; ++k) sums[k] += counts_[c * size + k];
  }
  [[nodiscard]] std::size_t copy_size() const { return (regions_ + 1) * static_cast<std::size_t>(most_bins); }

 private:
  static constexpr Index copies = 4;  // hide the latency of an increment
  std::uint32_t regions_;
  std::vector<std::uint32_t> counts_;
};

std::vector<Histogram> count_regions(std::span<const std::uint8_t> indices, const std::uint8_t* labels, Index regions,
                                     const IntensityBins& bins) {
  std::vector<std::int64_t> sums(RegionCounts(regions).copy_size());
  std::mutex mutex;  // sums of integers do not depend on the order
  parallel_for(std::ssize(indices), grain, [&](Index begin, Index end) {
    RegionCounts part(regions);
    part.count(indices.data() + begin, labels == nullptr ? nullptr : labels + begin, end - begin);
    const std::lock_guard lock(mutex);
    part.add_to(sums);
  });
  std::vector<Histogram> histograms(regions, Histogram(bins));
  for (Index r = 0; r < regions; ++r) {
    const auto first = sums.begin() + r * most_bins;
    auto& counts = histograms[r].counts;
    std::copy(first, first + bins.count, counts.begin());
    require(std::all_of(first + bins.count, first + most_bins, [](std::int64_t n) { return n == 0; }),
            "region_histograms", "indices", "beyond the bins", "must be those of bin_indices with the same bins");
  }
  return histograms;
}

}  // namespace

double Histogram::total() const {
  return std::accumulate(counts.begin(), counts.end(), 0.0);
}

double Histogram::mean() const {
  const double middle = .5 * (bins.lo + bins.hi);
  return middle + moment(1, middle);
}

double Histogram::moment(int order, double about) const {
  double sum = 0;
  for (Index k = 0; k < std::ssize(counts); ++k) {
    const double d = bins.center(k) - about;
    double power = 1;
    for (int i = 0; i < order; ++i) power *= d;
    sum += counts[k] * power;
  }
  const double n = total();
  return n > 0 ? sum / n : 0;
}

double Histogram::quantile(double fraction) const {
  const double n = total();
  double below = 0;
  if (n > 0) {
    for (Index k = 0; k < std::ssize(counts); ++k) {
      const double count = counts[k];
      if (count > 0 && below + count >= fraction * n)
        return bins.lo + (static_cast<double>(k) + std::max(0.0, fraction * n - below) / count) * bins.width();
      below += count;
    }
  }
  return .5 * (bins.lo + bins.hi);
}

IntensityBins choose_bins(std::span<const float> values, Index count, std::span<const std::uint8_t> mask) {
  require(count >= 2 && count <= most_bins, "choose_bins", "count", count, "must be 2 to 256");
  require(mask.empty() || mask.size() == values.size(), "choose_bins", "mask.size()", mask.size(),
          "must be the number of values: use a mask of the size of the image");
  const ValueRange range = range_of(values, mask);
  require(range.voxels > 0, "choose_bins", "number of values", range.voxels,
          "must be positive: the image or its mask is empty");
  require(range.finite, "choose_bins", "values", "NaN or infinity", "must be finite: replace or mask these voxels");
  require(range.lo < range.hi, "choose_bins", "values", range.lo,
          "must not be constant: regions of one intensity cannot be told apart");
  double lo = range.lo;
  double hi = range.hi;
  exclude_outliers(values, mask, lo, hi);
  const auto [level, gap] = find_levels(values, mask, range.integers);
  const double below = gap > 0 ? std::round((level - lo) / gap) : 0;
  const double between = gap > 0 ? below + std::round((hi - level) / gap) : static_cast<double>(count);
  if (between < static_cast<double>(count)) {
    const double first = level - (below + .5) * gap;
    return {first, first + (between + 1) * gap, static_cast<Index>(between) + 1};
  }
  if (!range.integers) {
    const double width = (hi - lo) / static_cast<double>(count - 1);
    const double first = lo - .5 * width;
    return {first, first + static_cast<double>(count) * width, count};
  }
  // Edges between the grey levels.
  const double first = std::floor(lo) - .5;
  const double levels = std::ceil(hi) + .5 - first;
  const double width = std::ceil(levels / static_cast<double>(count));
  const double used = std::ceil(levels / width);
  return {first, first + used * width, static_cast<Index>(used)};
}

std::vector<std::uint8_t> bin_indices(std::span<const float> values, const IntensityBins& bins) {
  require_bins("bin_indices", bins);
  std::vector<std::uint8_t> indices(values.size());
  parallel_for(std::ssize(values), grain, [&](Index begin, Index end) {
    simd<write_indices>(values.data() + begin, end - begin, bins, indices.data() + begin);
  });
  return indices;
}

std::vector<Histogram> region_histograms(std::span<const std::uint8_t> indices, std::span<const std::uint8_t> labels,
                                         Index regions, const IntensityBins& bins) {
  require_bins("region_histograms", bins);
  require(regions >= 1 && regions <= 256, "region_histograms", "regions", regions, "must be 1 to 256");
  require(indices.size() == labels.size(), "region_histograms", "labels.size()", labels.size(),
          "must be the number of voxels");
  return count_regions(indices, labels.data(), regions, bins);
}

Histogram histogram_of(std::span<const float> values, const IntensityBins& bins) {
  return std::move(count_regions(bin_indices(values, bins), nullptr, 1, bins).front());
}

}  // namespace csrbf
