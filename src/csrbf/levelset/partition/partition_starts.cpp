#include "csrbf/levelset/partition/partition_starts.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/levelset/image/box_mean.hpp"
#include "csrbf/levelset/image/common_background.hpp"
#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "csrbf/levelset/regions/intensity_classes.hpp"
#include "csrbf/levelset/regions/intensity_histogram.hpp"

#include <algorithm>

namespace csrbf {
namespace {

using Image = std::vector<float>;

class Starts {
 public:
  Starts(const PartitionPrice& price, const std::function<void(PartitionStart&&)>& take) : price_(price), take_(take) {}

  void make(int regions, bool few) {
    if (!price_.seeds().empty()) {
      for (const double sd : {0.0, 1.0, 2.0, 4.0}) like_seeds(blurred(price_.values(), sd), regions);
      return;
    }
    const std::vector<double> widths = few ? std::vector<double>{0, 1, 2} : std::vector<double>{0, 1, 2, 4};
    for (const double sd : widths) {
      const Image f = blurred(price_.values(), sd);
      classes(f, regions);
      if (few && regions > 2) continue;
      if (!few && (sd == 0 || sd == 2)) {
        for (const double part : {1.0 / 16, 1.0 / 6}) local(f, part, regions);
        for (const int degree : {1, 2}) without_trend(f, degree, regions);
      }
      if (regions > 2) continue;
      if (!few && sd < 2) outliers(f);
      if (sd == 0) shares(f, {0.001});
      if (few) continue;
      if (sd == 1) {
        shares(f, {0.005, 0.02, 0.1});
        transformed(f, [](float x) { return std::sqrt(x); });
        constexpr float dark = 1.0F / 256;  // a grey level of 256, against the logarithm of 0
        transformed(f, [](float x) { return std::log(x + dark); });
      }
    }
    if (few) return;
    of_ranks_ = true;
    const Image sorted = sorted_values(), shares_below = ranks(sorted);
    for (const double sd : {2.0, 4.0}) {
      const Image f = blurred(shares_below, sd);
      local(f, 1.0 / 6, regions);
      for (const int degree : {1, 2}) without_trend(f, degree, regions);
    }
    of_ranks_ = false;
    if (regions == 2) {
      texture();
      alike(sorted);
    }
  }

 private:
  [[nodiscard]] Image blurred(std::span<const float> values, double sd) const {
    Image f(values.begin(), values.end());
    if (sd == 0) return f;
    const Grid& grid = price_.grid();
    std::array<double, 3> along{0, 0, 0};
    for (std::size_t a = 0; a < 3; ++a) along[a] = sd * price_.weight().along[a];
    gaussian_blur(f, grid.size, along);
    return f;
  }

  [[nodiscard]] Image sorted_values() const {
    Image sorted;
    for (std::size_t i = 0; i < price_.values().size(); ++i)
      if (price_.inside(i)) sorted.push_back(price_.values()[i]);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }

  // The share of voxels that are darker, whatever tails the noise has.
  [[nodiscard]] Image ranks(const Image& sorted) const {
    Image f(price_.values().size(), 0.0F);
    const auto count = static_cast<float>(sorted.size());
    for (std::size_t i = 0; i < f.size(); ++i) {
      if (!price_.inside(i)) continue;
      const auto [first, last] = std::equal_range(sorted.begin(), sorted.end(), price_.values()[i]);
      f[i] = 0.5F * static_cast<float>((first - sorted.begin()) + (last - sorted.begin())) / count;
    }
    return f;
  }

  // Each voxel has the label of the seeds whose mean is nearest to its value.
  void like_seeds(const Image& f, int regions) {
    const std::span<const std::uint8_t> seeds = price_.seeds();
    std::vector<double> sums(static_cast<std::size_t>(regions), 0), counts = sums;
    for (std::size_t i = 0; i < f.size(); ++i) {
      if (seeds[i] == 0 || !price_.inside(i)) continue;
      sums[seeds[i] - 1] += static_cast<double>(f[i]);
      counts[seeds[i] - 1] += 1;
    }
    PartitionStart start{std::vector<std::uint8_t>(f.size()), true, true, true};
    for (std::size_t i = 0; i < f.size(); ++i) {
      double least = 1e30;
      for (std::size_t k = 0; k < sums.size(); ++k) {
        const double off = std::abs(static_cast<double>(f[i]) - sums[k] / counts[k]);
        if (off < least) start.labels[i] = static_cast<std::uint8_t>(k);
        least = std::min(least, off);
      }
      if (seeds[i] != 0) start.labels[i] = seeds[i] - 1;
    }
    take_(std::move(start));
  }

  // The classes of least variance.
  void classes(const Image& f, int regions, bool is_local = false) {
    const IntensityBins bins = choose_bins_of(f);
    if (!(bins.hi > bins.lo)) return;
    Histogram histogram(bins);
    Index filled = 0;
    for (std::size_t i = 0; i < f.size(); ++i)
      if (price_.inside(i)) histogram.add(static_cast<double>(f[i]));
    for (const double count : histogram.counts) filled += count > 0 ? 1 : 0;
    if (filled < regions) return;
    const IntensityClasses found = optimal_classes(histogram, regions);
    PartitionStart start{std::vector<std::uint8_t>(f.size()), !is_local, is_local, close_, of_ranks_};
    for (std::size_t i = 0; i < f.size(); ++i)
      for (const double threshold : found.thresholds)
        if (static_cast<double>(f[i]) > threshold) ++start.labels[i];
    take_(std::move(start));
  }

  [[nodiscard]] IntensityBins choose_bins_of(const Image& f) const {
    IntensityBins bins{1e30, -1e30, 256};
    for (std::size_t i = 0; i < f.size(); ++i) {
      if (!price_.inside(i)) continue;
      bins.lo = std::min(bins.lo, static_cast<double>(f[i]));
      bins.hi = std::max(bins.hi, static_cast<double>(f[i]));
    }
    return bins;
  }

  // The brightest and the darkest voxels.
  void shares(const Image& f, const std::vector<double>& parts, bool is_local = false) {
    Image sorted;
    for (std::size_t i = 0; i < f.size(); ++i)
      if (price_.inside(i)) sorted.push_back(f[i]);
    for (const double part : parts)
      for (const bool bright : {true, false}) {
        const float limit = percentile(sorted, bright ? 1 - part : part);
        PartitionStart start{std::vector<std::uint8_t>(f.size()), false, is_local};
        for (std::size_t i = 0; i < f.size(); ++i) start.labels[i] = (bright ? f[i] > limit : f[i] < limit) ? 1 : 0;
        take_(std::move(start));
      }
  }

  template <class Map>
  void transformed(Image f, const Map& map) {
    for (float& x : f) x = map(x);
    classes(f, 2);
  }

  // What differs from the mean of a box around it whose half width is that part of the longest side.
  void local(Image f, double part, int regions) {
    const Grid& grid = price_.grid();
    double longest = 0;
    for (int a = 0; a < 3; ++a) longest = std::max(longest, static_cast<double>(grid.size[a]) * grid.spacing[a]);
    std::array<Index, 3> half{0, 0, 0};
    for (int a = 0; a < grid.dimension(); ++a)
      half[a] = std::clamp<Index>(std::lround(part * longest / grid.spacing[a]), 1, grid.size[a]);
    Image mean = f;
    for (int pass = 0; pass < 3; ++pass) box_mean(mean, grid.size, half);
    for (std::size_t i = 0; i < f.size(); ++i) f[i] -= mean[i];
    close_ = part < 0.1 && !of_ranks_;
    classes(f, regions, true);
    close_ = false;
    if (part < 0.1 && regions == 2) shares(f, {0.01}, true);
  }

  // What is brighter, or darker, than light that varies: a local mean of all that does not stand out from it.
  void outliers(const Image& f) {
    constexpr double part = 1.0 / 16;  // standard deviation of the local mean, of the longest side
    constexpr double far = 2.5;        // standard deviations
    constexpr int rounds = 4;
    const Grid& grid = price_.grid();
    const LocalMean local_mean(grid, part);
    Image off = f, weight(f.size(), 1.0F), sizes;
    double limit = 0;
    for (int round = 0; round < rounds; ++round) {
      Image light(f.size());
      for (std::size_t i = 0; i < f.size(); ++i) {
        weight[i] = price_.inside(i) && (round == 0 || std::abs(static_cast<double>(off[i])) <= limit) ? 1.0F : 0.0F;
        light[i] = weight[i] * f[i];
      }
      local_mean.average(light, grid);
      local_mean.average(weight, grid);
      sizes.clear();
      for (std::size_t i = 0; i < f.size(); ++i) {
        off[i] = weight[i] > 0 ? f[i] - light[i] / weight[i] : 0.0F;
        if (price_.inside(i)) sizes.push_back(std::abs(off[i]));
      }
      limit = far * static_cast<double>(percentile(sizes, 0.5)) / median_of_normal;
    }
    for (const double side : {1.0, -1.0}) {
      PartitionStart start{std::vector<std::uint8_t>(f.size()), false, true};
      for (std::size_t i = 0; i < f.size(); ++i) start.labels[i] = side * static_cast<double>(off[i]) > limit ? 1 : 0;
      take_(std::move(start));
    }
  }

  // What a polynomial in all of the image leaves, as light that varies does.
  void without_trend(Image f, int degree, int regions) {
    Image trend(f.size());
    price_.fill_trend(f, degree, trend);
    for (std::size_t i = 0; i < f.size(); ++i) f[i] -= trend[i];
    classes(f, regions, true);
  }

  // By the size of what a Gaussian leaves.
  void texture() {
    Image f = blurred(price_.values(), 2);
    for (std::size_t i = 0; i < f.size(); ++i) f[i] = std::abs(f[i] - price_.values()[i]);
    f = blurred(f, 4);
    classes(f, 2);
  }

  // By the intensities that voxels a few apart have together more often than by chance: the function of intensities
  // that is most alike for such pairs. Regions differ in it whatever they differ in.
  void alike(const Image& sorted) {
    constexpr std::size_t levels = 32;  // of equal counts
    constexpr Index apart = 4;          // voxels: beyond the grain of most noise
    constexpr int steps = 200;          // of the power method, which ends at an eigenvector
    std::vector<float> limits;
    for (std::size_t k = 1; k < levels; ++k) {
      const float limit = sorted[k * sorted.size() / levels];
      if (limits.empty() || limit > limits.back()) limits.push_back(limit);
    }
    std::vector<std::size_t> level(price_.values().size());
    for (std::size_t i = 0; i < level.size(); ++i)
      level[i] =
          static_cast<std::size_t>(std::upper_bound(limits.begin(), limits.end(), price_.values()[i]) - limits.begin());
    Eigen::MatrixXd pairs = Eigen::MatrixXd::Constant(std::ssize(limits) + 1, std::ssize(limits) + 1, 1e-9);
    const Grid& grid = price_.grid();
    Index stride = 1;
    for (int a = 0; a < grid.dimension(); ++a) {
      for (Index i = 0; i < grid.voxels(); ++i) {
        const Index j = i + apart * stride;
        if (i / stride % grid.size[a] + apart >= grid.size[a] || !price_.inside(i) || !price_.inside(j)) continue;
        pairs(level[i], level[j]) += 1;
        pairs(level[j], level[i]) += 1;
      }
      stride *= grid.size[a];
    }
    const Eigen::VectorXd root = (pairs.rowwise().sum() / pairs.sum()).cwiseSqrt();
    const Eigen::MatrixXd excess =
        (pairs / pairs.sum()).cwiseQuotient(root * root.transpose()) - root * root.transpose();
    Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(root.size(), -1, 1).cwiseAbs2();
    v[0] -= 0.5;
    for (int step = 0; step < steps; ++step) v = (v + excess * v).normalized();  // eigenvalues from -1 to 1
    v = v.cwiseQuotient(root);
    Image f(level.size());
    for (std::size_t i = 0; i < f.size(); ++i) f[i] = static_cast<float>(v[level[i]]);
    for (const double sd : {2.0, 4.0}) classes(blurred(f, sd), 2);
  }

  const PartitionPrice& price_;
  const std::function<void(PartitionStart&&)>& take_;
  bool close_ = false, of_ranks_ = false;
};

}  // namespace

void for_partition_starts(const PartitionPrice& price, int regions, bool few,
                          const std::function<void(PartitionStart&&)>& take) {
  Starts(price, take).make(regions, few);
}

}  // namespace csrbf
