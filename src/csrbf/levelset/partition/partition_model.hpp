#pragma once

#include "csrbf/levelset/convex/convex_contour.hpp"
#include "csrbf/levelset/image/smooth_mean.hpp"
#include "csrbf/levelset/partition/region_moments.hpp"
#include "csrbf/levelset/partition/seed_costs.hpp"
#include "csrbf/levelset/regions/intensity_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace csrbf {

/// How the mean of a region varies over the image.
enum class MeanShape {
  constant,
  linear,
  quadratic,
  smooth,      ///< a quadratic and the smooth_mean() of what it leaves
  objects,     ///< one constant for each component of a region, a quadratic in the other
  background,  ///< a constant each, and a local mean of what both leave together
};

/// What the intensities of regions follow: means with independent deviations about them.
struct PartitionModel {
  MeanShape shape = MeanShape::constant;
  bool own_deviations = false;    ///< one standard deviation for each region, or one for all
  bool own_shapes = false;        ///< generalised Gaussians; without own_deviations one for what all means leave
  std::uint8_t object_label = 1;  ///< of MeanShape::objects
  double reach =
      smooth_reach;  ///< of smooth means and a background: standard deviation of the local mean, of the longest side

  bool operator==(const PartitionModel&) const = default;
};

/// Correlation of neighbours up to which voxels count as independent, as likelihoods take them to be; by hand.
inline constexpr double independent = 0.3;

/// What all models have to know of labels.
struct LabelMeasures {
  std::vector<RegionMoments> regions;
  double price = 0;  ///< of the contours, the places of the parts and the seeds that have other labels
};

/// The description length of an image by regions and their model, in nats: - log likelihood of the voxels in the mask,
/// half the logarithm of their number for each parameter (Rissanen 1978; Leclerc 1989), the price of the contours, and
/// of two regions the logarithm of that number for the place of each connected part. Instead of the contours of two
/// regions a code for the labels counts where it is shorter: contours in much noise are long for what they tell apart.
/// A constant that is the same for all labels and models of the image is left out.
class PartitionPrice {
 public:
  /// `values`: finite; lo < hi: the range that they are clipped to. No deviation is below half of one of its `levels`
  /// intensities. `mask` may be empty. Grid and mask must outlive this.
  PartitionPrice(std::span<const float> values, double lo, double hi, const Grid& grid,
                 std::span<const std::uint8_t> mask, const ContourWeight& weight, Index levels = 256);

  /// Voxels whose label is known; that of those that are not certain has its cost. Their labels must outlive this.
  void set_seeds(SeedCosts seeds);
  [[nodiscard]] std::span<const std::uint8_t> seeds() const { return seeds_.labels; }

  /// What the noise of each voxel has of variance, 1 over that; all over the mask have the geometric mean 1, so that
  /// prices with and without compare. Not for shapes of their own.
  void set_certainty(std::vector<float> certainty);
  [[nodiscard]] bool is_certainty_given() const { return !certainty_.empty(); }

  /// How many voxels say as much as one that is independent of its neighbours. The image is then described as one of
  /// voxels of that size: likelihoods are divided by it, lengths of contours by its edge.
  void set_grain(double voxels);
  [[nodiscard]] double grain() const { return grain_; }

  /// Makes contours cheaper by that factor.
  void scale_contours(double factor) {
    weight_.length *= factor;
    edge_scale_ *= factor;
  }

  [[nodiscard]] LabelMeasures measure(std::span<const std::uint8_t> labels, int regions = 2) const;

  /// Fits the model to the regions of the labels and returns the price; infinite when a region has fewer than 3 voxels
  /// that are independent.
  /// More than two regions have constant means. Polynomials take no time once the labels are measured, other means
  /// O(voxels).
  double fit(std::span<const std::uint8_t> labels, const LabelMeasures& measures, const PartitionModel& model);
  double fit(std::span<const std::uint8_t> labels, const PartitionModel& model, int regions = 2) {
    return fit(labels, measure(labels, regions), model);
  }

  /// The polynomial that values follow as one region.
  void fill_trend(std::span<const float> values, int degree, std::span<float> to) const;
  /// The price of the image as one region, whose mean is any but that of objects.
  double price_of_one_region(const PartitionModel& model);

  /// What each voxel costs in region k, by the last fit(); 0 outside the mask.
  void cost(int k, std::span<float> to);
  /// The cost in region 1 minus that in region 0.
  void force(std::span<float> to);

  /// Gives the parts of two regions that are not worth their contour and their place to the other region.
  void drop_parts(std::span<const float> force, std::span<std::uint8_t> labels) const;

  /// The part of the last fit() that is the likelihood of the voxels.
  [[nodiscard]] double deviation_price() const { return deviation_price_; }
  /// The same when every voxel belongs to region 1 by that share, and its mean leaves that residual.
  [[nodiscard]] double mixed_deviation_price(std::span<const float> share, std::span<const float> residual) const;
  /// The means of the last fit(), of both regions by the share of region 1.
  void mix_means(std::span<const float> share, std::span<float> to);

  /// What the means of the last fit() leave of each voxel; 0 outside the mask.
  [[nodiscard]] std::vector<float> rest(std::span<const std::uint8_t> labels);

  /// Correlation of what neighbours of one region leave, by the last fit(), in the region where it is largest: about 0
  /// when the voxels are independent, as the likelihood takes them to be, and when it is below what intensities
  /// resolve.
  [[nodiscard]] double correlation(std::span<const std::uint8_t> labels);

  /// Standard deviation of the means over their regions, where it is largest, over the contrast of the regions; of
  /// objects that of their means.
  [[nodiscard]] double variation(std::span<const std::uint8_t> labels);

  /// The largest standard deviation of a region over the smallest, by the last fit().
  [[nodiscard]] double deviation_ratio() const {
    const auto [least, most] = std::minmax_element(variances_.begin(), variances_.end());
    return std::sqrt(*most / *least);
  }

  /// The region with the largest, by the last fit().
  [[nodiscard]] std::size_t most_deviating() const {
    return static_cast<std::size_t>(std::max_element(variances_.begin(), variances_.end()) - variances_.begin());
  }

  /// The values, clipped to the range and in its units; 0 outside the mask.
  [[nodiscard]] std::span<const float> values() const { return values_; }
  [[nodiscard]] bool inside(std::size_t i) const { return mask_.empty() || mask_[i] != 0; }
  [[nodiscard]] const Grid& grid() const { return grid_; }
  [[nodiscard]] const ContourWeight& weight() const { return weight_; }
  [[nodiscard]] std::span<const std::uint8_t> mask() const { return mask_; }
  [[nodiscard]] double voxels() const { return count_; }
  /// Half a level of the intensities, of the range.
  [[nodiscard]] double least_deviation() const { return 0.5 / static_cast<double>(bins_.count); }
  /// Means of the regions, of those that vary averaged, in units of the range.
  [[nodiscard]] const std::vector<double>& means() const { return means_; }

 private:
  [[nodiscard]] double certainty(std::size_t i) const {
    return certainty_.empty() ? 1 : static_cast<double>(certainty_[i]);
  }
  [[nodiscard]] double value(std::size_t i) const { return static_cast<double>(values_[i]); }
  [[nodiscard]] double mean(std::size_t k, std::size_t i) const {
    return fields_[k].empty() ? means_[k] : static_cast<double>(fields_[k][i]);
  }
  // That of a voxel; of a law for all means that of what they leave.
  [[nodiscard]] std::size_t bin(std::size_t k, std::size_t i) const {
    return model_.own_deviations ? indices_[i] : static_cast<std::size_t>(bins_.index(value(i) - mean(k, i) + 0.5));
  }
  [[nodiscard]] double place_price() const { return std::log(count_ / grain_); }
  [[nodiscard]] std::vector<std::uint8_t> masked(std::span<const std::uint8_t> labels) const;
  void fill_fields();
  void fill_field(std::size_t k);
  void fill_rows(const MeanPolynomial& polynomial, std::span<float> to) const;
  [[nodiscard]] double fit_background(std::span<const std::uint8_t> labels);
  [[nodiscard]] double add_smooth_mean(std::span<const std::uint8_t> labels, std::size_t k);
  [[nodiscard]] double fit_objects(std::span<const std::uint8_t> labels, std::uint8_t k);
  [[nodiscard]] double residual(std::span<const std::uint8_t> labels, std::size_t k) const;
  double fit_deviations(const std::vector<double>& squares);
  double fit_shapes(std::span<const std::uint8_t> labels);

  std::vector<float> values_, certainty_;
  const Grid& grid_;
  std::span<const std::uint8_t> mask_;
  SeedCosts seeds_;
  std::vector<std::size_t> uncertain_;  // seeds
  ContourWeight weight_;
  double count_ = 0, grain_ = 1, deviation_price_ = 0;
  double edge_scale_ = 1;  // what a voxel's edge of a contour costs, of what it costs without grain
  RegionMoments all_;      // of both of two regions
  PartitionModel model_;
  IntensityBins bins_;
  std::vector<std::uint8_t> indices_;       // of the values, once they are asked for
  std::vector<std::vector<float>> tables_;  // of the costs of bins, of own shapes
  std::vector<double> means_, counts_, variances_;
  std::vector<MeanPolynomial> polynomials_;  // of the regions, where their means are some
  std::vector<std::vector<float>> fields_;   // means that vary, once they are asked for
};

}  // namespace csrbf
