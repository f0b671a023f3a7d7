#include "csrbf/levelset/segment_missing.hpp"

#include "csrbf/levelset/partition/needed_regions.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

namespace csrbf {
namespace {

std::string exactly(const MissingBlock& block) {
  std::ostringstream text;
  text.precision(3);
  text << 100 * block.share << " % of the voxels, which are exactly ";
  text.precision(9);
  text << block.value << ", farther from all others than these are from one another";
  return text.str();
}

// Where the price of the regions says whether the rest has any.
bool may_leave_out(const SegmentOptions& options, Index voxels) {
  return chooses_model(options) && !is_large(options, voxels) && options.seed.empty() && options.seeds.empty();
}

}  // namespace

bool may_leave_out(const MissingBlock& block, const SegmentOptions& options, Index voxels) {
  constexpr double least = 100;  // voxels that may have regions; by hand
  return !block.may_be_dark_or_bright && may_leave_out(options, voxels) &&
         (1 - block.share) * static_cast<double>(voxels) >= least;
}

bool may_leave_out_frame(const SegmentOptions& options, const Volume<float>& image) {
  return (options.regions == 2 || image.components == 1) && may_leave_out(options, image.grid.voxels());
}

std::optional<ImageFrame> find_frame_to_leave_out(const Volume<float>& image, const SegmentOptions& options) {
  constexpr double hardly = 0.01;  // of the picture; by hand
  if (!may_leave_out_frame(options, image)) return std::nullopt;
  std::optional<ImageFrame> frame = find_image_frame(image, options.mask);
  if (!frame || options.regions == 2) return frame;
  double all = 0, same = 0;
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    if (frame->outside[i] != 0 || (!options.mask.empty() && options.mask[i] == 0) || std::isnan(image.values[i]))
      continue;
    all += 1;
    same += image.values[i] == frame->value ? 1 : 0;
  }
  return same < hardly * all ? std::move(frame) : std::nullopt;
}

bool has_all_regions(const Volume<float>& image, const std::vector<std::uint8_t>& picture,
                     std::span<const std::uint8_t> labels, int regions) {
  if (regions == 2) return true;
  const std::vector<float> repaired = finite_values(image, picture);
  return are_all_regions_needed(repaired.empty() ? image.values : repaired, image.grid, picture, contour_length, labels,
                                regions);
}

std::vector<std::uint8_t> without_frame(const ImageFrame& frame, std::vector<std::uint8_t> mask) {
  if (mask.empty()) mask.assign(frame.outside.size(), 1);
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (frame.outside[i] != 0) mask[i] = 0;
  return mask;
}

std::string left_out_text(const ImageFrame& frame) {
  std::ostringstream text;
  text.precision(3);
  text << 100 * frame.share << " % of the voxels, which frame the picture with exactly ";
  text.precision(9);
  text << frame.value << (frame.values > 1 ? " and other single values" : "")
       << ", are left out as missing; if they are not, give nan as the value of missing ones";
  return text.str();
}

bool is_mostly(const DrawnOver& drawn, std::span<const std::uint8_t> labels, int label) {
  std::size_t all = 0, of_it = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] != label) continue;
    ++all;
    of_it += drawn.voxels[i] != 0 ? 1 : 0;
  }
  return 2 * of_it > all;
}

std::string drawn_over_text(const DrawnOver& drawn, int label) {
  std::ostringstream text;
  text << "label " << label << " is mostly thin strokes of exactly " << std::setprecision(9) << drawn.value
       << ": if they are text or arrows drawn over the picture, give that value as the one of missing ones";
  return text.str();
}

bool finds_regions(const std::vector<std::string>& warnings) {
  return std::find(warnings.begin(), warnings.end(), nothing_found) == warnings.end();
}

std::string left_out_text(const MissingBlock& block) {
  return exactly(block) + ", are left out as missing; if they are not, give nan as the value of missing ones";
}

std::string is_label_text(const MissingBlock& block, int label) {
  return "label " + std::to_string(label) + " is " + exactly(block) +
         ": if they are missing, give that value as the one of missing ones";
}

}  // namespace csrbf
