#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/levelset/regions/force_source.hpp"
#include "csrbf/levelset/regions/region_model.hpp"

#include <vector>

namespace csrbf {

/// Forces from the intensities of an image: the statistics of each region and, from them, the cost of each voxel in it.
/// Labels of voxels outside the mask are ignored. Internal to segment().
template <int Dim>
class RegionForces final : public ForceSource {
 public:
  /// `values`: finite, one per voxel; `mask` and `prior` as in SegmentOptions. They must outlive this. Throws
  /// InvalidInput for a constant image.
  RegionForces(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask, IntensityLaw law,
               int regions, std::span<const float> prior = {});

  /// Labels to start from. Classes of the intensities; for the laws that distinguish textures the likeliest of these
  /// and of classes of local contrast.
  [[nodiscard]] std::vector<std::uint8_t> start();

  void fit(std::span<const std::uint8_t> labels) override;
  void undo() override;
  double force(int k, double scale, std::span<float> force) const override;

  /// Half width of the boxes over which costs are averaged.
  void set_window(int window) { std::fill_n(window_.begin(), Dim, window); }

  /// Width of the borders between regions that laws with a width are not fitted to; 0: they are fitted to all voxels.
  void set_border(Index border) { border_ = border; }

  /// Lets the means of the regions vary: polynomials of that degree (0, 1, 2) from the next fit() on.
  void set_shading_degree(int degree) { degree_ = degree; }

  /// Share of the variance within the regions, noise from voxel to voxel aside, that linear means explain; 0 when these
  /// vary by a small part of the contrast only.
  [[nodiscard]] double shading_explains(std::span<const std::uint8_t> labels) const;

 private:
  struct Statistics {
    std::vector<RegionModel> models;
    std::vector<Eigen::VectorXd> means;  // in monomials(); those of degree 0 when there is no shading
  };
  static constexpr int terms = (Dim + 1) * (Dim + 2) / 2;  // of a quadratic polynomial
  using Terms = Eigen::Matrix<double, terms, 1>;
  // Sums over voxels of a region for the least-squares fit of its mean.
  struct Moments {
    Eigen::Matrix<double, terms, terms> A = Eigen::Matrix<double, terms, terms>::Zero();
    Terms b = Terms::Zero();
    double squares = 0;
    [[nodiscard]] double count() const { return A(0, 0); }
    [[nodiscard]] Terms fit(int used) const;
  };
  [[nodiscard]] Terms monomials(Index x, Index y, Index z) const;
  [[nodiscard]] std::vector<Moments> moments(std::span<const std::uint8_t> labels) const;
  [[nodiscard]] double noise_variance() const;
  [[nodiscard]] bool inside(std::size_t i) const { return mask_.empty() || mask_[i] != 0; }
  void make_tables();
  void fit_means(std::span<const std::uint8_t> labels);
  [[nodiscard]] std::vector<Histogram> histograms(std::span<const std::uint8_t> labels) const;
  void fit_models(std::span<const std::uint8_t> labels);
  void texture_labels(int moment, std::vector<std::uint8_t>& labels) const;
  double settle(std::vector<std::uint8_t>& labels);
  double table_force(int k, double scale, std::span<float> force) const;
  double shaded_force(int k, double scale, std::span<float> force) const;

  std::span<const float> values_;
  Grid grid_;
  std::span<const std::uint8_t> mask_;
  IntensityLaw law_;
  std::array<Index, 3> window_{0, 0, 0};
  Index border_ = 3;  // voxels; by hand: larger leaves thin regions without a core
  int degree_ = 0;
  IntensityBins bins_;
  std::vector<std::uint8_t> indices_;
  Histogram all_;
  Statistics statistics_, saved_;
  std::vector<std::vector<float>> tables_;
};

}  // namespace csrbf
