#include "csrbf/levelset/partition/blurred_classes.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "csrbf/levelset/regions/intensity_classes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace csrbf {
namespace {

constexpr std::array<double, 7> deviations{0.5, 0.7, 1, 1.4, 2, 2.8, 4};  // of the Gaussians, in voxels
constexpr double widest_of_tissues = 2;
constexpr double part = 0.7;    // of the noise that is added; the other image has its inverse subtracted. By hand
constexpr Index enough = 1000;  // second differences

class Judge {
 public:
  Judge(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask, int regions)
      : values_(values), grid_(grid), mask_(mask), regions_(static_cast<std::size_t>(regions)) {}

  // From second differences along x; 0 where there are too few.
  [[nodiscard]] double noise() const {
    std::vector<double> differences;
    const Index nx = grid_.size[0];
    for (Index i = 1; i + 1 < std::ssize(values_); ++i) {
      if (i % nx == 0 || i % nx == nx - 1 || !inside(i - 1) || !inside(i) || !inside(i + 1)) continue;
      differences.push_back(std::abs(static_cast<double>(values_[i - 1]) - 2 * static_cast<double>(values_[i]) +
                                     static_cast<double>(values_[i + 1])));
    }
    if (std::ssize(differences) < enough) return 0;
    return median(differences) / median_of_normal / std::sqrt(6);
  }

  // The two images with independent noise.
  void split(double noise, std::vector<float>& seen, std::vector<float>& unseen) const {
    std::mt19937_64 random(1);  // its sequence is fixed by the standard
    const auto uniform = [&] { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; };
    seen.assign(values_.begin(), values_.end());
    unseen = seen;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const double u = uniform(), angle = 2 * std::numbers::pi * uniform();
      const double e = noise * std::sqrt(-2 * std::log(u)) * std::cos(angle);
      seen[i] += static_cast<float>(part * e);
      unseen[i] -= static_cast<float>(e / part);
    }
  }

  [[nodiscard]] std::vector<std::uint8_t> classes(std::span<const float> values, double deviation) const {
    std::array<double, 3> along{0, 0, 0};
    const double shortest = grid_.spacing.head(grid_.dimension()).minCoeff();
    for (int a = 0; a < grid_.dimension(); ++a)
      along[static_cast<std::size_t>(a)] = deviation * shortest / grid_.spacing[a];
    std::vector<float> sum(values.size()), weight(values.size());
    for (std::size_t i = 0; i < sum.size(); ++i) {
      weight[i] = inside(static_cast<Index>(i)) ? 1.0F : 0.0F;
      sum[i] = weight[i] * values[i];
    }
    gaussian_blur(sum, grid_.size, along);
    gaussian_blur(weight, grid_.size, along);
    constexpr float none = 1e-6F;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(weight[i], none);
    const IntensityBins bins = choose_bins(sum, 256, mask_);
    Histogram histogram(bins);
    for (std::size_t i = 0; i < sum.size(); ++i)
      if (inside(static_cast<Index>(i))) histogram.add(static_cast<double>(sum[i]));
    const IntensityClasses found = optimal_classes(histogram, static_cast<Index>(regions_));
    std::vector<std::uint8_t> labels(sum.size(), 0);
    for (std::size_t i = 0; i < sum.size(); ++i)
      for (const double threshold : found.thresholds)
        if (static_cast<double>(sum[i]) > threshold) ++labels[i];
    return labels;
  }

  // The squares that the means of the labels leave.
  [[nodiscard]] double squares(std::span<const float> values, const std::vector<std::uint8_t>& labels) const {
    std::vector<double> sums(regions_, 0), counts(regions_, 0);
    double all = 0;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (!inside(static_cast<Index>(i))) continue;
      const auto value = static_cast<double>(values[i]);
      sums[labels[i]] += value;
      counts[labels[i]] += 1;
      all += value * value;
    }
    for (std::size_t k = 0; k < regions_; ++k)
      if (counts[k] > 0) all -= sums[k] * sums[k] / counts[k];
    return all;
  }

  [[nodiscard]] double voxels() const {
    const auto out = mask_.empty() ? 0 : std::count(mask_.begin(), mask_.end(), std::uint8_t{0});
    return static_cast<double>(std::ssize(values_) - out);
  }

 private:
  [[nodiscard]] bool inside(Index i) const { return mask_.empty() || mask_[i] != 0; }

  std::span<const float> values_;
  const Grid& grid_;
  std::span<const std::uint8_t> mask_;
  std::size_t regions_;
};

}  // namespace

std::optional<BlurredClasses> blurred_classes(
    std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask, int regions,
    const std::function<std::vector<std::uint8_t>(std::span<const float>)>& find, double worth) {
  const Judge judge(values, grid, mask, regions);
  const double noise = judge.noise();
  if (!(noise > 0)) return std::nullopt;
  std::vector<float> seen, unseen;
  judge.split(noise, seen, unseen);
  double least = judge.squares(unseen, find(seen)) * std::exp(-2 * worth / judge.voxels());
  std::optional<double> best;
  for (const double deviation : deviations) {
    if (regions > 2 && deviation > widest_of_tissues) break;
    const double left = judge.squares(unseen, judge.classes(seen, deviation));
    if (left >= least) continue;
    least = left;
    best = deviation;
  }
  if (!best) return std::nullopt;
  return BlurredClasses{judge.classes(values, *best), *best};
}

}  // namespace csrbf
