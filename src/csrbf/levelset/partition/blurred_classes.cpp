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
constexpr double enough_of_region = 30;
constexpr double reach = 0.125;  // of the Gaussian of a local mean, of the longest side; by hand

class Judge {
 public:
  Judge(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask, int regions)
      : values_(values),
        grid_(grid),
        mask_(mask),
        regions_(static_cast<std::size_t>(regions)),
        everywhere_(values.size(), 0) {
    for (std::size_t i = 0; i < mask.size(); ++i) everywhere_[i] = mask[i] != 0 ? 0 : 255;
  }

  // Of the whole image, from the median of second differences along x; 0 where there are too few.
  [[nodiscard]] double noise() const {
    std::vector<double> differences;
    for_differences([&](Index, double difference) { differences.push_back(std::abs(difference)); });
    if (std::ssize(differences) < enough) return 0;
    return median(differences) / median_of_normal / std::sqrt(6);
  }

  // Of each of two regions, from the squares of those inside it: of all tails.
  [[nodiscard]] std::array<double, 2> noise(std::span<const std::uint8_t> labels, double otherwise) const {
    std::array<double, 2> sums{}, counts{};
    for_differences([&](Index i, double difference) {
      if (labels[i - 1] != labels[i] || labels[i + 1] != labels[i]) return;
      sums[labels[i]] += difference * difference;
      counts[labels[i]] += 1;
    });
    std::array<double, 2> result{};
    for (std::size_t k = 0; k < 2; ++k)
      result[k] = counts[k] < enough_of_region ? otherwise : std::sqrt(sums[k] / counts[k] / 6);
    return result;
  }

  // The two images with independent noise, of such deviations.
  template <class Noise>
  void split(const Noise& noise, std::vector<float>& seen, std::vector<float>& unseen) const {
    std::mt19937_64 random(1);  // its sequence is fixed by the standard
    const auto uniform = [&] { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; };
    seen.assign(values_.begin(), values_.end());
    unseen = seen;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const double u = uniform(), angle = 2 * std::numbers::pi * uniform();
      const double e = noise(i) * std::sqrt(-2 * std::log(u)) * std::cos(angle);
      seen[i] += static_cast<float>(part * e);
      unseen[i] -= static_cast<float>(e / part);
    }
  }

  [[nodiscard]] std::vector<std::uint8_t> classes(std::span<const float> values, double deviation) const {
    std::vector<float> sum(values.begin(), values.end());
    blur(sum, deviation);
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

  // Less the polynomial of that degree, or less the mean around each voxel.
  [[nodiscard]] std::vector<float> without_light(std::span<const float> values, MeanShape light) const {
    std::vector<float> result(values.begin(), values.end());
    if (light == MeanShape::constant) return result;
    std::vector<float> mean = result;
    if (light == MeanShape::smooth) {
      blur(mean, reach * static_cast<double>(*std::max_element(grid_.size.begin(), grid_.size.end())));
    } else {
      const MeanPolynomial polynomial(region_moments(values, everywhere_, 0, grid_), static_cast<int>(light), grid_);
      const Index nx = grid_.size[0];
      for (Index row = 0; row < grid_.voxels() / nx; ++row)
        polynomial.fill_row(row,
                            std::span(mean).subspan(static_cast<std::size_t>(row * nx), static_cast<std::size_t>(nx)));
    }
    for (std::size_t i = 0; i < result.size(); ++i) result[i] -= mean[i];
    return result;
  }

  // In nats of normal noise, of one deviation for all labels or of their own, about means that are polynomials.
  [[nodiscard]] double price(std::span<const float> values, std::vector<std::uint8_t> labels, int degree,
                             bool own_deviations = false) const {
    for (std::size_t i = 0; i < mask_.size(); ++i)
      if (mask_[i] == 0) labels[i] = 255;
    double all = 0, squares = 0, nats = 0;
    for (std::size_t k = 0; k < regions_; ++k) {
      const RegionMoments region = region_moments(values, labels, static_cast<std::uint8_t>(k), grid_);
      if (!(region.count() > 0)) continue;
      const double left = MeanPolynomial(region, degree, grid_).residual(region);
      nats += 0.5 * region.count() * std::log(std::max(left, 1e-30) / region.count());
      squares += left;
      all += region.count();
    }
    return own_deviations ? nats : 0.5 * all * std::log(std::max(squares, 1e-30) / all);
  }

 private:
  [[nodiscard]] bool inside(Index i) const { return mask_.empty() || mask_[i] != 0; }

  // By a Gaussian of that deviation in edges of the shortest kind; values outside the mask do not count.
  void blur(std::vector<float>& values, double deviation) const {
    std::array<double, 3> along{0, 0, 0};
    const double shortest = grid_.spacing.head(grid_.dimension()).minCoeff();
    for (int a = 0; a < grid_.dimension(); ++a)
      along[static_cast<std::size_t>(a)] = deviation * shortest / grid_.spacing[a];
    std::vector<float> weight(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      weight[i] = inside(static_cast<Index>(i)) ? 1.0F : 0.0F;
      values[i] *= weight[i];
    }
    gaussian_blur(values, grid_.size, along);
    gaussian_blur(weight, grid_.size, along);
    constexpr float none = 1e-6F;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] /= std::max(weight[i], none);
  }

  template <class Take>
  void for_differences(const Take& take) const {
    const Index nx = grid_.size[0];
    for (Index i = 1; i + 1 < std::ssize(values_); ++i) {
      if (i % nx == 0 || i % nx == nx - 1 || !inside(i - 1) || !inside(i) || !inside(i + 1)) continue;
      take(i, static_cast<double>(values_[i - 1]) - 2 * static_cast<double>(values_[i]) +
                  static_cast<double>(values_[i + 1]));
    }
  }

  std::span<const float> values_;
  const Grid& grid_;
  std::span<const std::uint8_t> mask_;
  std::size_t regions_;
  std::vector<std::uint8_t> everywhere_;  // 0 within the mask
};

// Clipped to what normal noise would reach.
std::vector<float> without_tails(std::span<const float> values, std::span<const std::uint8_t> mask) {
  constexpr double reach_of_normal = 3;  // deviations
  std::vector<double> part;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (mask.empty() || mask[i] != 0) part.push_back(static_cast<double>(values[i]));
  const double middle = median(part);
  for (double& each : part) each = std::abs(each - middle);
  const double most = reach_of_normal * median(part) / median_of_normal;
  std::vector<float> result(values.begin(), values.end());
  for (float& value : result)
    value = std::clamp(value, static_cast<float>(middle - most), static_cast<float>(middle + most));
  return result;
}

}  // namespace

std::optional<BlurredClasses> blurred_classes(
    std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask, int regions,
    const Partition& found, const std::function<std::vector<std::uint8_t>(std::span<const float>)>& find) {
  std::vector<float> clipped;
  if (found.model.own_shapes) values = clipped = without_tails(values, mask);
  const Judge judge(values, grid, mask, regions);
  const double noise = judge.noise();
  if (!(noise > 0)) return std::nullopt;
  const bool two = regions == 2, varies = found.model.shape != MeanShape::constant;
  const int degree = varies ? 2 : 0;
  std::vector<float> seen, unseen;
  if (two) {
    const std::array<double, 2> each = judge.noise(found.labels, noise);
    judge.split([&](std::size_t i) { return each[found.labels[i]]; }, seen, unseen);
  } else {
    judge.split([&](std::size_t) { return noise; }, seen, unseen);
  }
  const std::vector<std::uint8_t> others = two ? found.labels : find(seen);
  const double worth = two ? 0.5 * std::log(static_cast<double>(values.size())) : 0;
  double least = judge.price(unseen, others, degree) - worth;
  std::optional<BlurredClasses> best;
  for (const MeanShape light : {MeanShape::constant, MeanShape::linear, MeanShape::quadratic, MeanShape::smooth}) {
    if (light != MeanShape::constant && !varies) break;
    const std::vector<float> rest = judge.without_light(seen, light);
    for (const double deviation : deviations) {
      if (!two && deviation > widest_of_tissues) break;
      std::vector<std::uint8_t> labels = judge.classes(rest, deviation);
      const double left = judge.price(unseen, labels, degree);
      if (left >= least) continue;
      least = left;
      best = {std::move(labels), deviation, light};
    }
  }
  // Regions that differ in their deviations, too, are not given up for others that do not.
  if (!best || (found.model.own_deviations &&
                judge.price(unseen, best->labels, degree, true) >= judge.price(unseen, others, degree, true) - worth))
    return std::nullopt;
  best->labels = judge.classes(judge.without_light(values, best->light), best->deviation);
  return best;
}

}  // namespace csrbf
