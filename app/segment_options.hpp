#pragma once

#include "session.hpp"

#include "csrbf/levelset/segment.hpp"

namespace csrbf::app {

/// What the flags say, but for --init and --mask. Throws UsageError.
SegmentOptions make_segment_options(const SegmentFlags& flags);

/// Adds the options used to the report.
void add_segment_options(const SegmentFlags& flags, const SegmentSettings& used, Session& session);

/// Throws UsageError for images that are not one grey image of two or three axes with something to see. `path` is what
/// the image is called.
void check_image(const std::string& path, const Volume<float>& image);

/// Throws UsageError for a voxel in the mask (empty: everywhere) whose value is NaN or infinite.
void check_finite(const std::string& path, const Volume<float>& image, const std::vector<std::uint8_t>& mask);

}  // namespace csrbf::app
