#pragma once

#include "csrbf/levelset/image/channel_contrast.hpp"
#include "csrbf/levelset/segment_options.hpp"

namespace csrbf {

/// Segments an image of several components by `segment_sum`, given the weighted sum in which two classes differ.
template <class SegmentSum>
auto segment_channels(const Volume<float>& image, const SegmentOptions& options, const SegmentSum& segment_sum) {
  const Volume<float> channels = root_channels(image, options.mask);
  const std::vector<double> weights = channel_contrast(channels, options.mask);
  auto found = segment_sum(weigh_channels(channels, weights));
  found.report.channels = weights;
  return found;
}

}  // namespace csrbf
