#pragma once

#include "csrbf/core/grid.hpp"

#include <Eigen/Core>

#include <array>
#include <span>
#include <vector>

namespace csrbf {

/// The price of an image of one or two regions each of whose voxels is predicted, up to a normal deviation, from its
/// neighbours along the axes: an autoregressive model for each region, by which textures of the same mean and deviation
/// differ. A voxel may be coded after the neighbours before it or after those behind it; the price is the mean of both
/// codes. Unlike prices of independent voxels it does not take the grain of a texture for regions.
class NeighbourCode {
 public:
  /// No deviation is below `least`. The arrays and the grid must outlive this; `mask` may be empty.
  NeighbourCode(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask, double least)
      : values_(values), grid_(grid), mask_(mask), least_(least) {}

  /// Fits the predictions of the regions, label 0 or any other; the price of the voxels and of the parameters in nats,
  /// infinite when a region has fewer than 3 voxels. No labels: one region. Without predictions of their own the
  /// regions differ in means and deviations alone. O(voxels).
  double fit(std::span<const std::uint8_t> labels, bool own_predictions = true);

  /// What each voxel costs in region 1 minus that in region 0, by the last fit() of two regions; 0 outside the mask.
  void force(std::span<float> to) const;

  /// The share of the variance of a region that is predicted, by the last fit().
  [[nodiscard]] double predicted(std::size_t region) const { return regions_[region].predicted; }

  /// The product of each voxel with its neighbours, all less the mean of the image.
  void fill_products(std::span<float> to) const;

 private:
  struct Region {
    double count = 0, mean = 0, variance = 0, predicted = 0;
    Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();  // of the neighbour along each axis
  };
  // A voxel and its neighbours before and behind along the axes, less a mean; 0 where there are none.
  struct Place {
    double value = 0;
    Eigen::Vector3d before = Eigen::Vector3d::Zero(), behind = Eigen::Vector3d::Zero();
  };
  template <class Body>
  void for_voxels(Index begin_row, Index end_row, const Body& body) const;
  [[nodiscard]] Place place(const std::array<Index, 3>& at, Index voxel, double mean) const;
  [[nodiscard]] double square(const Region& region, const std::array<Index, 3>& at, Index voxel) const;
  [[nodiscard]] bool inside(Index i) const { return mask_.empty() || mask_[i] != 0; }

  std::span<const float> values_;
  const Grid& grid_;
  std::span<const std::uint8_t> mask_;
  double least_;
  std::vector<Region> regions_;
};

}  // namespace csrbf
