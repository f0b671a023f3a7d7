#pragma once

#include "csrbf/core/grid.hpp"

#include <span>
#include <vector>

namespace csrbf {

/// The roots of channels of light, which are not negative, on a scale that keeps their maximum; other channels as they
/// are. A stain shows by the logarithm of the light that passes it, the noise by the light itself: the root is half way
/// between the two. Voxels outside the mask (may be empty) or not finite do not count.
Volume<float> root_channels(Volume<float> image, std::span<const std::uint8_t> mask);

/// The direction in the space of the channels of an image (its components) in which the means of two classes differ: of
/// the two classes, among those that the principal axes lead to, that leave the least sum of squares over all channels.
/// With means and one deviation for all channels the energy of two regions depends on the projection on it only (Chan,
/// Sandberg and Vese 2000). Of length 1, with a positive sum. Channels count as they are: they should share a unit.
/// From at most 262144 voxels at equal distances; those outside the mask (may be empty) or not finite are left out.
std::vector<double> channel_contrast(const Volume<float>& image, std::span<const std::uint8_t> mask);

/// The image with one component, the sum of the others times these weights.
Volume<float> weigh_channels(const Volume<float>& image, const std::vector<double>& weights);

}  // namespace csrbf
