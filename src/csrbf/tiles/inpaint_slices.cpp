#include "csrbf/tiles/inpaint_slices.hpp"

#include "csrbf/approx/images/missing_voxels.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/io/volume_stream.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace csrbf {
namespace {

constexpr const char* slices_function = "inpaint_slices";

// Bytes of memory: without an image, for each voxel of a block, for each sample of a fit; measured: 15e6, 50, 250.
constexpr double image_program_bytes = 30e6, block_voxel_bytes = 60, block_sample_bytes = 300;
// Slices that a block sees of others: those within the rim of inpaint(), and of the blocks that refine what it says.
constexpr double rim_voxels_seen = 8, rim_depths_seen = 2, refined_voxels = 16, refined_voxels_if_deep = 32;
constexpr double deep_voxels = 8;

// The files, some slices at a time.
class SlicesToFill {
 public:
  SlicesToFill(const std::string& image, const InpaintSlicesOptions& options)
      : image_(opened(image, "image")), value_(options.missing) {
    const VolumeLayout& layout = image_.layout();
    require(layout.grid.size[2] > 1, slices_function, "slices", layout.grid.size[2],
            "an image of one slice cannot be cut into blocks");
    if (value_ && layout.type == SampleType::float32) value_ = static_cast<double>(static_cast<float>(*value_));
    if (options.mask.empty()) return;
    mask_.emplace(opened(options.mask, "mask"));
    const Grid& grid = mask_->layout().grid;
    if (grid.size != layout.grid.size)
      throw InvalidInput(options.mask + ": the mask has " + size_text(grid) + " pixels, the image " +
                         size_text(layout.grid));
    if (grid.space != Space::unknown && layout.grid.space != Space::unknown && distance_apart(grid, layout.grid) > 0)
      throw InvalidInput(options.mask + ": the voxels of the mask are not where those of the image are: " +
                         places_text(grid, layout.grid) + "; resample it to the image");
  }

  [[nodiscard]] const VolumeLayout& layout() const { return image_.layout(); }
  [[nodiscard]] Index slice_voxels() const { return layout().grid.size[0] * layout().grid.size[1]; }

  Volume<double> read(Index begin, Index end) {
    VolumeLayout part = layout();
    part.grid.size[2] = end - begin;
    Volume<double> image(part);
    image_.read(begin, end, std::span(image.values));
    return image;
  }

  // Which voxels of these slices are missing.
  VoxelMask missing(Index begin, const Volume<double>& image) {
    VoxelMask missing(image.values.size(), 0);
    if (mask_) {
      const std::span<const float> marks = mask_->read(begin, begin + image.grid.size[2]);
      for (std::size_t i = 0; i < missing.size(); ++i) missing[i] = marks[i] != 0 ? 1 : 0;
    }
    for (std::size_t i = 0; i < missing.size(); ++i)
      if (!std::isfinite(image.values[i]) || (value_ && image.values[i] == *value_)) missing[i] = 1;
    return missing;
  }

 private:
  static VolumeStream opened(const std::string& path, const std::string& what) {
    std::optional<VolumeStream> stream = VolumeStream::open(path);
    if (!stream)
      throw IoError(path +
                    ": only a .nii, .nii.gz or .npy file of one component and one frame can be read by slices; "
                    "convert the " +
                    what);
    return *std::move(stream);
  }

  VolumeStream image_;
  std::optional<VolumeStream> mask_;
  std::optional<double> value_;
};

// What is missing in an image.
struct MissingSlices {
  std::vector<Index> counts;  // in each slice
  std::vector<Index> starts;  // of holes, which come first along the axes; a hole may have several
  double depth = 0;           // how far missing voxels are from known ones at most, or a little less than that

  [[nodiscard]] Index within(Index begin, Index end) const { return sum(counts, begin, end); }
  [[nodiscard]] Index starts_within(Index begin, Index end) const { return sum(starts, begin, end); }

 private:
  static Index sum(const std::vector<Index>& of, Index begin, Index end) {
    return std::accumulate(of.begin() + begin, of.begin() + end, Index{0});
  }
};

// Missing voxels of a slice without missing neighbours before them.
Index hole_starts(const VoxelMask& missing, const VoxelMask& before, const Grid& grid) {
  const Index nx = grid.size[0], ny = grid.size[1];
  Index starts = 0;
  for (Index y = 0; y < ny; ++y)
    for (Index x = 0; x < nx; ++x) {
      const auto here = static_cast<std::size_t>(x + nx * y);
      if (missing[here] == 0) continue;
      bool is_first = x == 0 || missing[here - 1] == 0;
      for (Index b = std::max<Index>(0, y - 1); b <= std::min(ny - 1, y + 1); ++b)
        for (Index a = std::max<Index>(0, x - 1); a <= std::min(nx - 1, x + 1); ++a) {
          const auto at = static_cast<std::size_t>(a + nx * b);
          if (before[at] != 0 || (b < y && missing[at] != 0)) is_first = false;
        }
      starts += is_first ? 1 : 0;
    }
  return starts;
}

MissingSlices survey(SlicesToFill& slices, const Progress& progress) {
  const Grid& grid = slices.layout().grid;
  MissingSlices found;
  std::vector<float> behind(static_cast<std::size_t>(slices.slice_voxels()), 0);  // to the last known voxel along z
  VoxelMask before(behind.size(), 0);
  const auto step = static_cast<float>(grid.spacing.z());
  for (Index z = 0; z < grid.size[2]; ++z) {
    report(progress, "survey", static_cast<double>(z) / static_cast<double>(grid.size[2]));
    const Volume<double> slice = slices.read(z, z + 1);
    const VoxelMask missing = slices.missing(z, slice);
    found.counts.push_back(std::count(missing.begin(), missing.end(), 1));
    found.starts.push_back(hole_starts(missing, before, grid));
    before = missing;
    if (found.counts.back() == 0) {
      std::fill(behind.begin(), behind.end(), 0.0F);
      continue;
    }
    const std::vector<float> within = distance_to(false, missing, slice.grid);
    for (std::size_t i = 0; i < missing.size(); ++i) {
      behind[i] = missing[i] != 0 ? behind[i] + step : 0;
      found.depth = std::max(found.depth, static_cast<double>(std::min(behind[i], within[i])));
    }
  }
  return found;
}

double rim_seen(const Grid& grid, double depth) {
  return std::max(rim_voxels_seen * mean_spacing(grid), rim_depths_seen * depth);
}

// Slices around those of a block that it sees.
Index slices_around(const Grid& grid, double depth) {
  const double spacing = mean_spacing(grid);
  const double refined = (depth > deep_voxels * spacing ? refined_voxels_if_deep : refined_voxels) * spacing;
  return static_cast<Index>(std::ceil(std::max(rim_seen(grid, depth), refined) / grid.spacing.z()));
}

// Voxels of the box that inpaint() fills a hole in.
double box_voxels(const Grid& grid, double depth) {
  const double side = 2 * (rim_seen(grid, depth) + depth);
  return (side / grid.spacing.array() + 1).prod();
}

struct Slices {
  Index begin = 0, end = 0;
};

// Blocks of slices whose missing values are filled together.
class Blocks {
 public:
  Blocks(const MissingSlices& missing, const Grid& grid, double memory)
      : missing_(missing),
        count_(grid.size[2]),
        slice_(static_cast<double>(grid.size[0] * grid.size[1])),
        around_(slices_around(grid, missing.depth)),
        box_(box_voxels(grid, missing.depth)),
        memory_(memory) {
    if (fits({0, count_})) {
      blocks_ = {{0, count_}};
      return;
    }
    for (Index begin = 0; begin < count_;) {
      const Slices next = missing_.counts[begin] > 0 ? next_from(begin) : Slices{begin, begin + 1};
      if (missing_.counts[begin] > 0) blocks_.push_back(next);
      begin = next.end;
    }
  }

  [[nodiscard]] const std::vector<Slices>& all() const { return blocks_; }
  [[nodiscard]] Slices seen(const Slices& block) const {
    return {std::max<Index>(0, block.begin - around_), std::min(count_, block.end + around_)};
  }

  // The block that sees the most missing values.
  [[nodiscard]] std::size_t richest() const {
    std::size_t best = 0;
    Index most = -1;
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      const Slices part = seen(blocks_[k]);
      const Index count = missing_.within(part.begin, part.end);
      if (count > most) best = k;
      most = std::max(most, count);
    }
    return best;
  }

 private:
  [[nodiscard]] double bytes(const Slices& part) const {
    const double voxels = slice_ * static_cast<double>(part.end - part.begin);
    const double boxes = box_ * static_cast<double>(missing_.starts_within(part.begin, part.end));
    const double known = voxels - static_cast<double>(missing_.within(part.begin, part.end));
    const double samples = boxes <= voxels ? std::min(box_, known) : known;  // hole by hole, or all at once
    return image_program_bytes + block_voxel_bytes * voxels + block_sample_bytes * samples;
  }
  [[nodiscard]] bool fits(const Slices& part) const { return bytes(part) <= memory_; }

  // As many slices as fit, up to a gap that no block sees across; ending where little is missing.
  [[nodiscard]] Slices next_from(Index begin) const {
    const Index least = std::min(count_, begin + 1 + around_ / 2);  // with fewer, most slices are those around them
    if (!fits(seen({begin, least}))) refuse(bytes(seen({begin, least})));
    Index end = begin, gap = 0;
    while (end < count_ && gap <= 2 * around_ && fits(seen({begin, end + 1}))) {
      gap = missing_.counts[end] == 0 ? gap + 1 : 0;
      ++end;
    }
    if (end == count_ || gap > 2 * around_) return {begin, end - gap};
    Index best = end;
    for (Index cut = end; cut > begin + (end - begin) / 2; --cut)
      if (cost(cut) < cost(best)) best = cut;
    return {begin, best};
  }
  // Missing voxels on both sides.
  [[nodiscard]] Index cost(Index cut) const { return missing_.counts[cut - 1] + missing_.counts[cut]; }

  [[noreturn]] void refuse(double needed) const {
    constexpr double mega = 1e6;
    throw InvalidInput(
        std::string(slices_function) + ": memory = " + std::to_string(static_cast<Index>(memory_ / mega)) +
        " MB: is too little; give at least " + std::to_string(static_cast<Index>(std::ceil(needed / mega))) + " MB");
  }

  const MissingSlices& missing_;
  Index count_;
  double slice_;  // voxels
  Index around_;
  double box_;  // voxels of that of a hole
  double memory_;
  std::vector<Slices> blocks_;
};

class FillBySlices {
 public:
  FillBySlices(SlicesToFill& slices, const InpaintSlicesOptions& options, const std::string& output)
      : slices_(slices), options_(options.inpaint), memory_(options.memory), writer_(output, slices.layout()) {}

  InpaintSlicesReport run() {
    const MissingSlices missing = survey(slices_, options_.progress);
    const Grid& grid = slices_.layout().grid;
    const Blocks blocks(missing, grid, memory_);
    const Index total = missing.within(0, grid.size[2]);
    InpaintSlicesReport report{{}, slices_.layout(), total > 0 ? std::ssize(blocks.all()) : 0};
    std::vector<double> values;  // of the block that chooses the plan
    const std::size_t richest = blocks.richest();
    parts_ = static_cast<double>(report.blocks);
    if (total > 0) {
      values = fill(blocks.all()[richest], blocks, report.inpaint);
      options_.plan = report.inpaint.plan;
    }
    Index done = 0;
    for (std::size_t k = 0; total > 0 && k < blocks.all().size(); ++k) {
      const Slices& block = blocks.all()[k];
      copy({done, block.begin}, {});
      InpaintReport ignored;
      copy(block, k == richest ? values : fill(block, blocks, ignored));
      done = block.end;
    }
    copy({done, grid.size[2]}, {});
    writer_.commit();
    report.inpaint.missing = total;
    report.inpaint.known = grid.voxels() - total;
    return report;
  }

 private:
  // The values of the missing voxels of a block, in their order.
  std::vector<double> fill(const Slices& block, const Blocks& blocks, InpaintReport& report) {
    const Slices seen = blocks.seen(block);
    Volume<double> image = slices_.read(seen.begin, seen.end);
    const VoxelMask missing = slices_.missing(seen.begin, image);
    InpaintOptions options = options_;
    if (options_.progress)
      options.progress = [&](std::string_view stage, double fraction) {
        return options_.progress(stage, (filled_ + fraction) / parts_);
      };
    report = inpaint(image, missing, options);
    ++filled_;
    std::vector<double> values;
    const Index voxels = slices_.slice_voxels();
    for (Index i = (block.begin - seen.begin) * voxels; i < (block.end - seen.begin) * voxels; ++i)
      if (missing[i] != 0) values.push_back(image.values[i]);
    return values;
  }

  // Writes slices, some at a time, with these values where they are missing.
  void copy(const Slices& part, const std::vector<double>& values) {
    constexpr Index voxels_at_once = Index{1} << 20;
    const Index step = std::max<Index>(1, voxels_at_once / slices_.slice_voxels());
    std::size_t used = 0;
    for (Index begin = part.begin; begin < part.end; begin += step) {
      Volume<double> image = slices_.read(begin, std::min(part.end, begin + step));
      if (!values.empty()) {
        const VoxelMask missing = slices_.missing(begin, image);
        for (std::size_t i = 0; i < missing.size(); ++i)
          if (missing[i] != 0) image.values[i] = values[used++];
      }
      writer_.write(encode_samples(image, image.type));
    }
  }

  SlicesToFill& slices_;
  InpaintOptions options_;
  double memory_;
  VolumeWriter writer_;
  double parts_ = 1, filled_ = 0;  // blocks, and those that are filled
};

}  // namespace

InpaintSlicesReport inpaint_slices(const std::string& image, const std::string& output,
                                   const InpaintSlicesOptions& options) {
  require(options.memory > 0, slices_function, "memory", options.memory, "must be positive");
  if (!VolumeWriter::can_write(output))
    throw InvalidInput(output + ": only .nii, .nii.gz and .npy files are written by slices");
  SlicesToFill slices(image, options);
  require(options.inpaint.extrapolation != Extrapolation::nan || is_floating(slices.layout().type), slices_function,
          "extrapolation", "nan", "the image holds whole numbers, which cannot be NaN");
  return FillBySlices(slices, options, output).run();
}

}  // namespace csrbf
