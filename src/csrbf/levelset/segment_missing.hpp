#pragma once

#include "csrbf/levelset/disturbances/drawn_over.hpp"
#include "csrbf/levelset/frame/image_frame.hpp"
#include "csrbf/levelset/frame/missing_voxels.hpp"
#include "csrbf/levelset/segment_checks.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace csrbf {

/// Whether a block of one value may be left out unasked: where the price of the regions says whether the rest has any.
bool may_leave_out(const MissingBlock& block, const SegmentOptions& options, Index voxels);

/// The same of what frames the picture. With several components, two regions only.
bool may_leave_out_frame(const SegmentOptions& options, const Volume<float>& image);

/// What frames the picture, if it may be left out unasked. Of three and more regions the frame may be one: its value
/// must then be one that hardly a voxel of the picture has.
std::optional<ImageFrame> find_frame_to_leave_out(const Volume<float>& image, const SegmentOptions& options);

/// Whether the picture in a frame has as many regions as were asked for; of two the warnings tell.
bool has_all_regions(const Volume<float>& image, const std::vector<std::uint8_t>& picture,
                     std::span<const std::uint8_t> labels, int regions);

/// The mask (empty: all voxels) without that frame.
std::vector<std::uint8_t> without_frame(const ImageFrame& frame, std::vector<std::uint8_t> mask);

/// What a user is told of a frame that was left out.
std::string left_out_text(const ImageFrame& frame);

/// What a user is told of such a block: that it was left out, or that it is label `label`.
std::string left_out_text(const MissingBlock& block);
std::string is_label_text(const MissingBlock& block, int label);

/// Whether most of a region is the drawing, and what a user is told then.
bool is_mostly(const DrawnOver& drawn, std::span<const std::uint8_t> labels, int label);
std::string drawn_over_text(const DrawnOver& drawn, int label);

/// Whether two regions describe the image better than one, by the warnings of a segmentation.
bool finds_regions(const std::vector<std::string>& warnings);

/// Segments the voxels that are not missing, where `segment_known` segments those of a mask. A block of one value far
/// from all others and what frames the picture are left out, too, unless `missing` is given, if the regions asked for
/// describe the rest better than fewer.
template <class SegmentKnown>
auto segment_without_missing(const Volume<float>& image, SegmentOptions options, const SegmentKnown& segment_known) {
  const std::optional<double> value = options.missing;
  const auto known_only = [&](const std::optional<double>& missing, const std::vector<std::uint8_t>& mask) {
    SegmentOptions known = options;
    known.mask = without_missing_voxels(image, missing, mask);
    known.missing = std::numeric_limits<double>::quiet_NaN();
    const auto in = [](const std::vector<std::uint8_t>& one) {
      return static_cast<double>(one.size()) - static_cast<double>(std::count(one.begin(), one.end(), 0));
    };
    const double before = options.mask.empty() ? static_cast<double>(image.grid.voxels()) : in(options.mask);
    const double left = known.mask.empty() ? before : in(known.mask);
    require(left > 0, "segment", "missing", missing.value_or(std::numeric_limits<double>::quiet_NaN()),
            "is the value of all voxels");
    auto found = segment_known(known);
    if (left < before) found.report.missing = (before - left) / before;
    found.report.options.missing = missing;
    return found;
  };
  const std::optional<MissingBlock> block = value ? std::nullopt : find_missing_block(image, options.mask);
  if (block && may_leave_out(*block, options, image.grid.voxels())) {
    auto found = known_only(block->value, options.mask);
    if (finds_regions(found.report.warnings)) {
      found.report.warnings.push_back(left_out_text(*block));
      return found;
    }
  } else if (const auto frame = value ? std::nullopt : find_frame_to_leave_out(image, options)) {
    const auto picture = without_missing_voxels(image, value, without_frame(*frame, options.mask));
    auto found = known_only(value, picture);
    if (finds_regions(found.report.warnings) && has_all_regions(image, picture, found.labels, options.regions)) {
      found.report.warnings.push_back(left_out_text(*frame));
      return found;
    }
  }
  auto found = known_only(value, options.mask);
  for (int label = 0; block && label < found.report.options.regions; ++label) {
    bool same = true;
    for (std::size_t i = 0; i < found.labels.size() && same; ++i)
      same = (found.labels[i] == label) == (image.values[i] == block->value) || std::isnan(image.values[i]) ||
             (!options.mask.empty() && options.mask[i] == 0);
    if (same) found.report.warnings.push_back(is_label_text(*block, label));
  }
  return found;
}

/// Warns where a region may be text, scale bars and arrows drawn over the picture, unless `missing` is given.
template <class Found>
void warn_of_drawing(const Volume<float>& image, const SegmentOptions& options, Found& found) {
  if (options.missing || options.regions != 2 || !may_leave_out_frame(options, image)) return;
  const std::optional<DrawnOver> drawn = find_drawn_over(image, options.mask);
  for (int label = 0; drawn && label < 2; ++label)
    if (is_mostly(*drawn, found.labels, label)) found.report.warnings.push_back(drawn_over_text(*drawn, label));
}

}  // namespace csrbf
