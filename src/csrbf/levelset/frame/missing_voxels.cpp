#include "csrbf/levelset/frame/missing_voxels.hpp"

#include "csrbf/levelset/frame/image_frame.hpp"
#include "csrbf/levelset/regions/label_runs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

constexpr double together = 0.9;     // of the voxels, in parts that reach the border; by hand
constexpr double most_others = 0.1;  // of the faces of these voxels, between them and others; by hand: a block is thick

// The two least and the two greatest values, which differ.
struct Ends {
  float least, next_least, next_greatest, greatest;
};

template <class Inside>
Ends ends_of(std::span<const float> values, const Inside& inside) {
  constexpr float all = std::numeric_limits<float>::infinity();
  Ends ends{all, all, -all, -all};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float x = values[i];
    if (!inside(i)) continue;
    if (x < ends.least) {
      ends.next_least = ends.least;
      ends.least = x;
    } else if (x > ends.least && x < ends.next_least) {
      ends.next_least = x;
    }
    if (x > ends.greatest) {
      ends.next_greatest = ends.greatest;
      ends.greatest = x;
    } else if (x < ends.greatest && x > ends.next_greatest) {
      ends.next_greatest = x;
    }
  }
  return ends;
}

// The value that is far from all others, if there are two of these at least.
std::optional<float> lonely_end(const Ends& ends) {
  const float others_of_least = ends.greatest - ends.next_least, others_of_greatest = ends.next_greatest - ends.least;
  if (others_of_least > 0 && ends.next_least - ends.least > others_of_least) return ends.least;
  if (others_of_greatest > 0 && ends.greatest - ends.next_greatest > others_of_greatest) return ends.greatest;
  return std::nullopt;
}

bool at_border(const Grid& grid, Index row, const LabelRuns::Run& run) {
  const auto [nx, ny, nz] = grid.size;
  const Index y = row % ny, z = row / ny;
  return run.begin == 0 || run.end == nx || (ny > 2 && (y == 0 || y + 1 == ny)) || (nz > 2 && (z == 0 || z + 1 == nz));
}

// Whether it is a negative value that marks missing voxels wherever they are: a whole number such as -9999 where no
// other is negative, or one which is beyond any scale of theirs.
bool is_mark(float value, const Ends& ends) {
  constexpr float beyond = 10, mark = -99;  // by hand
  return value < 0 && value == ends.least &&
         ((ends.next_least >= 0 && value <= mark && value == std::floor(value)) ||
          ends.next_least - value > beyond * (ends.greatest - ends.next_least));
}

// What the darkest and brightest things have, too: 0 and 1, and where the sensors of 8 to 14 bits end.
bool may_be_thing(float value) {
  constexpr std::array<float, 6> ends = {0, 1, 255, 1023, 4095, 16383};
  return std::find(ends.begin(), ends.end(), value) != ends.end();
}

// Whether nearly all of the marked voxels are in parts that reach the border of the image.
bool reaches_border(const std::vector<std::uint8_t>& marked, const Grid& grid) {
  LabelRuns runs(marked, grid);
  const LabelRuns::Parts parts = runs.parts(1);
  std::vector<Index> sizes(parts.count, 0);
  std::vector<bool> border(parts.count, false);
  for (std::size_t row = 0; row + 1 < runs.first.size(); ++row)
    for (std::size_t i = runs.first[row]; i < runs.first[row + 1]; ++i) {
      const std::int32_t part = parts.of_run[i];
      if (part < 0) continue;
      sizes[part] += runs.runs[i].end - runs.runs[i].begin;
      if (at_border(grid, static_cast<Index>(row), runs.runs[i])) border[part] = true;
    }
  double all = 0, there = 0;
  for (std::size_t part = 0; part < sizes.size(); ++part) {
    all += static_cast<double>(sizes[part]);
    if (border[part]) there += static_cast<double>(sizes[part]);
  }
  return there >= together * all;
}

// Whether few of the faces of marked voxels are those of others.
bool is_thick(const std::vector<std::uint8_t>& marked, const Grid& grid) {
  double same = 0, other = 0;
  Index stride = 1;
  for (int a = 0; a < grid.dimension(); ++a) {
    for (Index i = 0; i + stride < grid.voxels(); ++i) {
      if (i / stride % grid.size[a] + 1 == grid.size[a]) continue;
      const int marks = marked[i] + marked[i + stride];
      same += marks == 2 ? 2 : 0;
      other += marks == 1 ? 1 : 0;
    }
    stride *= grid.size[a];
  }
  return other <= most_others * (same + other);
}

}  // namespace

std::vector<std::uint8_t> without_missing_voxels(const Volume<float>& image, std::optional<double> value,
                                                 std::vector<std::uint8_t> mask) {
  const Index components = image.components;
  for (Index i = 0; i < image.grid.voxels(); ++i) {
    const std::span<const float> here(image.values.data() + i * components, static_cast<std::size_t>(components));
    const bool missing =
        std::any_of(here.begin(), here.end(), [](float x) { return std::isnan(x); }) ||
        (value && std::all_of(here.begin(), here.end(), [&](float x) { return x == static_cast<float>(*value); }));
    if (!missing) continue;
    if (mask.empty()) mask.assign(static_cast<std::size_t>(image.grid.voxels()), 1);
    mask[i] = 0;
  }
  return mask;
}

std::optional<MissingBlock> find_missing_block(const Volume<float>& image, std::span<const std::uint8_t> mask) {
  if (image.components != 1) return std::nullopt;
  const auto inside = [&](std::size_t i) { return mask.empty() || mask[i] != 0; };
  const Ends ends = ends_of(image.values, inside);
  const std::optional<float> value = lonely_end(ends);
  if (!value || !std::isfinite(*value) || is_drawing(image.values)) return std::nullopt;
  std::vector<std::uint8_t> marked(image.values.size(), 0);
  double count = 0, known = 0;
  for (std::size_t i = 0; i < marked.size(); ++i) {
    if (!inside(i)) continue;
    marked[i] = image.values[i] == *value ? 1 : 0;
    known += 1;
    count += marked[i];
  }
  constexpr double several = 4;
  const bool anywhere = is_mark(*value, ends) && count >= several;
  if (!anywhere && (!is_thick(marked, image.grid) || !reaches_border(marked, image.grid))) return std::nullopt;
  return MissingBlock{*value, count / known, may_be_thing(*value)};
}

}  // namespace csrbf
