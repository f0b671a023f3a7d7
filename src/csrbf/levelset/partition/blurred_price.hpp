#pragma once

#include "csrbf/levelset/partition/partition_model.hpp"

namespace csrbf {

/// A description of an image by two regions that a Gaussian blurs.
struct BlurredFit {
  double price = 0;             ///< in nats, as of PartitionPrice
  double blur = 0;              ///< deviation of the Gaussian, in edges of the shortest kind
  std::vector<float> residual;  ///< what it leaves of each voxel, in its deviations; 0 outside the mask
};

/// The shortest description of the image by these labels and that model when cameras are given what they do: voxels at
/// the border of regions mix the means of both, by a Gaussian of 0, 0.7, 1.4 or 2.8 voxels. Of means that a border
/// blurs, sharp ones take the noise of the border for its shape: labels that follow it seem cheaper than the true ones.
/// O(voxels).
BlurredFit fit_blurred(PartitionPrice& price, std::span<const std::uint8_t> labels, const PartitionModel& model);

/// What of it is the likelihood of the voxels, for one of these blurs.
double blurred_likelihood(PartitionPrice& price, std::span<const std::uint8_t> labels, const PartitionModel& model,
                          double blur);

/// Correlation of what neighbours leave, along the axis where it is largest.
double residual_correlation(std::span<const float> residual, const Grid& grid);

/// What is alike in neighbours more than two voxels from the contour: the mean product of what blurred means leave of
/// them, along the axis where it is largest; 0 of noise.
double structures_left(PartitionPrice& price, std::span<const std::uint8_t> labels, const PartitionModel& model);

/// Where the image is blurred, moves the contour by up to two voxels to where the image, alone or after a Gaussian of
/// 0.5 to 2 voxels, crosses the middle between the means that the regions have before the blur, or a level close to it;
/// means, blur and contour in turns, while the price falls. Contours of single voxels follow the noise of a blurred
/// border, and thin objects without noise are too thick for means of their voxels. True if it is moved: where what
/// blurred means leave is correlated, for a fifth of that. O(voxels), about 50 Gaussians.
bool place_blurred_contour(PartitionPrice& price, const PartitionModel& model, std::vector<std::uint8_t>& labels);

/// Whether two regions are farther apart than halves or peaks of noise are, for the deviation of what they leave, by
/// its median.
bool are_clear(PartitionPrice& price, std::span<const std::uint8_t> labels, const PartitionModel& model);

}  // namespace csrbf
