#pragma once

#include "commands/commands.hpp"

#include "csrbf/levelset/seed.hpp"
#include "csrbf/levelset/segment.hpp"

namespace csrbf::app {

/// The options that the flags ask for, except --init and --mask. Throws UsageError.
SegmentOptions make_segment_options(const SegmentFlags& flags);

/// Adds the options used to the report.
void add_segment_options(const SegmentFlags& flags, const SegmentSettings& used, Session& session);

/// Throws UsageError unless the image is a single 2D or 3D greyscale image and not constant. `path` is its name in
/// messages.
void check_image(const std::string& path, const Volume<float>& image);

/// Throws UsageError for a voxel that is not a number, and says what to do.
[[noreturn]] void refuse_voxel(const std::string& path, const Grid& grid, Index voxel, float value);

/// Throws UsageError for a voxel in the mask (empty: everywhere) whose value is NaN or infinite.
void check_finite(const std::string& path, const Volume<float>& image, const std::vector<std::uint8_t>& mask);

/// The voxels that --init WHERE covers; none for auto. Throws UsageError for other forms and for places outside the
/// image, IoError for files.
template <int Dim>
Seed read_seed(const std::string& where, const Grid& grid, const Progress& progress);

/// The labels of an image with this layout; `memory`: to be used for them.
Volume<float> label_image(const VolumeLayout& layout, const std::vector<std::uint8_t>& labels,
                          std::vector<float> memory = {});

/// The voxels of --mask FILE, or those in --mask box:X,Y[,Z],X,Y[,Z]. Throws UsageError when it has another size or
/// covers no voxel, IoError.
template <int Dim>
std::vector<std::uint8_t> read_mask(const std::string& where, const Grid& grid);

/// Where an image has values other than 0. Throws UsageError when it has another size, IoError.
std::vector<std::uint8_t> read_voxels(const std::string& flag, const std::string& path, const Grid& grid);

}  // namespace csrbf::app
