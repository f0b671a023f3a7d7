#include "csrbf/levelset/objects/split_objects.hpp"

#include "csrbf/levelset/objects/distance_basins.hpp"
#include "csrbf/levelset/objects/join_basins.hpp"
#include "csrbf/levelset/objects/seams.hpp"
#include "csrbf/levelset/regions/label_runs.hpp"

#include <algorithm>
#include <limits>
#include <span>

namespace csrbf {
namespace {

constexpr double explained = 0.5;    // of the seams, at least; by hand: textures up to 0.45, seams 0.55 and more
constexpr double unexplained = 1.5;  // nats for each voxel of a seam, which is two voxels wide

struct Split {
  std::vector<std::int32_t> labels;
  std::vector<double> prices;  // of the labels
};

Split join(std::vector<std::int32_t> labels, const Grid& grid) {
  Split result{std::move(labels), {}};
  result.prices = join_basins(result.labels, grid);
  return result;
}

// Runs `take(voxels from, to, connected part)`.
template <class Take>
void for_runs_inside(const LabelRuns& runs, const LabelRuns::Parts& parts, Index width, const Take& take) {
  for (std::size_t row = 0; row + 1 < runs.first.size(); ++row)
    for (std::size_t i = runs.first[row]; i < runs.first[row + 1]; ++i) {
      const Index at = static_cast<Index>(row) * width;
      if (parts.of_run[i] >= 0) take(at + runs.runs[i].begin, at + runs.runs[i].end, parts.of_run[i]);
    }
}

// Of each connected part the labels of least price, with that of deep seams that are no borders.
std::vector<std::int32_t> cheapest(const Split& a, const Split& b, const std::vector<std::uint8_t>& deep,
                                   const std::vector<std::uint8_t>& inside, const Grid& grid) {
  LabelRuns runs(inside, grid);
  const LabelRuns::Parts parts = runs.parts(1);
  std::vector<double> gain(parts.count, 0);
  const auto add = [&](const Split& split, double sign) {
    std::vector<std::uint8_t> seen(split.prices.size(), 0);
    for_runs_inside(runs, parts, grid.size[0], [&](Index begin, Index end, std::int32_t part) {
      for (Index i = begin; i < end; ++i) {
        const std::int32_t label = split.labels[i];
        if (deep[i] != 0 && !is_at_border(split.labels, i, grid)) gain[part] += sign * unexplained;
        if (label == 0) gain[part] = -std::numeric_limits<double>::infinity();
        if (label == 0 || seen[label] != 0) continue;
        seen[label] = 1;
        gain[part] += sign * split.prices[label];
      }
    });
  };
  add(a, 1);
  add(b, -1);
  std::vector<std::int32_t> labels = a.labels;
  const auto above = static_cast<std::int32_t>(a.prices.size());
  for_runs_inside(runs, parts, grid.size[0], [&](Index begin, Index end, std::int32_t part) {
    if (gain[part] > 0)
      for (Index i = begin; i < end; ++i) labels[i] = above + b.labels[i];
  });
  return labels;
}

}  // namespace

std::vector<std::int32_t> split_objects(const Volume<float>& image, const std::vector<std::uint8_t>& inside) {
  const Grid& grid = image.grid;
  Split by_shape = join(distance_basins(inside, grid), grid);
  const std::vector<std::uint8_t> seams = find_seams(image, inside);
  std::vector<std::uint8_t> deep = seams;
  keep_deep(deep, inside, grid);
  const auto many = std::count(deep.begin(), deep.end(), 1);
  if (many == 0) return std::move(by_shape.labels);
  Split by_seams{basins_between(seams, inside, grid), {}};
  by_seams.prices = join_basins(by_seams.labels, grid, seams);
  std::vector<std::int32_t> labels = cheapest(by_shape, by_seams, deep, inside, grid);
  Index borders = 0;
  for (Index i = 0; i < std::ssize(deep); ++i) borders += deep[i] != 0 && is_at_border(labels, i, grid) ? 1 : 0;
  const bool are_explained = static_cast<double>(borders) >= explained * static_cast<double>(many);
  return are_explained ? std::move(labels) : std::move(by_shape.labels);
}

}  // namespace csrbf
