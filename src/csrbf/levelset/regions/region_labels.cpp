#include "csrbf/levelset/regions/region_labels.hpp"

#include "csrbf/core/voxel_axes.hpp"
#include "csrbf/levelset/regions/label_runs.hpp"

namespace csrbf {
namespace {

bool takes_part(std::span<const std::uint8_t> mask, std::size_t i) {
  return mask.empty() || mask[i] != 0;
}

}  // namespace

Index count_components(std::span<const std::uint8_t> labels, const Grid& grid) {
  LabelRuns parts(labels, grid);
  Index count = 0;
  for (std::size_t i = 0; i < parts.runs.size(); ++i)
    if (parts.runs[i].label != 0 && parts.sets.find(static_cast<std::uint32_t>(i)) == i) ++count;
  return count;
}

Index fill_enclosed(std::span<std::uint8_t> labels, const Grid& grid, std::span<const std::uint8_t> seeds) {
  const Index nx = grid.size[0], ny = grid.size[1], nz = grid.size[2];
  LabelRuns parts(labels, grid);
  std::vector<bool> open(parts.runs.size(), false);
  const auto is_marked = [&](Index row, const LabelRuns::Run& run) {
    if (seeds.empty()) return false;
    const auto voxels =
        seeds.subspan(static_cast<std::size_t>(nx * row + run.begin), static_cast<std::size_t>(run.end - run.begin));
    return std::find(voxels.begin(), voxels.end(), std::uint8_t{1}) != voxels.end();
  };
  for (Index row = 0; row < ny * nz; ++row) {
    const Index y = row % ny, z = row / ny;
    const bool side = (ny > 1 && (y == 0 || y == ny - 1)) || (nz > 1 && (z == 0 || z == nz - 1));
    for (std::size_t i = parts.first[row]; i < parts.first[static_cast<std::size_t>(row) + 1]; ++i)
      if (side || parts.runs[i].begin == 0 || parts.runs[i].end == nx || is_marked(row, parts.runs[i]))
        open[parts.sets.find(static_cast<std::uint32_t>(i))] = true;
  }
  Index filled = 0;
  for (Index row = 0; row < ny * nz; ++row)
    for (std::size_t i = parts.first[row]; i < parts.first[static_cast<std::size_t>(row) + 1]; ++i) {
      const LabelRuns::Run& run = parts.runs[i];
      if (run.label != 0 || open[parts.sets.find(static_cast<std::uint32_t>(i))]) continue;
      std::fill(labels.begin() + nx * row + run.begin, labels.begin() + nx * row + run.end, std::uint8_t{1});
      filled += run.end - run.begin;
    }
  return filled;
}

int seeded_region(std::span<const std::uint8_t> labels, std::span<const std::uint8_t> seed,
                  std::span<const std::uint8_t> mask) {
  constexpr double clear = 0.05;  // difference of the covered shares over their sum; by hand: less is chance
  std::array<double, 2> voxels{0, 0}, covered{0, 0};
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!takes_part(mask, i)) continue;
    const std::size_t k = labels[i] != 0 ? 1 : 0;
    voxels[k] += 1;
    if (seed[i] != 0) covered[k] += 1;
  }
  const double a = covered[0] / std::max(voxels[0], 1.0), b = covered[1] / std::max(voxels[1], 1.0);
  if (std::abs(a - b) <= clear * (a + b)) return -1;
  return b > a ? 1 : 0;
}

void count_border(std::span<const std::uint8_t> labels, const Grid& grid, std::span<const std::uint8_t> mask,
                  Index begin, Index end, std::span<Index> counts) {
  const auto [nx, ny, nz] = grid.size;
  for (Index z = begin; z < end; ++z)
    for (Index y = 0; y < ny; ++y) {
      const bool side = (ny > 1 && (y == 0 || y == ny - 1)) || (nz > 1 && (z == 0 || z == nz - 1));
      const Index step = side ? 1 : std::max<Index>(1, nx - 1);
      for (Index x = 0; x < nx; x += step) {
        const auto i = static_cast<std::size_t>(grid.index(x, y, z - begin));
        if (takes_part(mask, static_cast<std::size_t>(grid.index(x, y, z))))
          ++counts[std::min<std::size_t>(labels[i], counts.size() - 1)];
      }
    }
}

int border_region(std::span<const std::uint8_t> labels, const Grid& grid, std::span<const std::uint8_t> mask,
                  int regions) {
  std::vector<Index> counts(regions, 0);
  count_border(labels, grid, mask, 0, grid.size[2], counts);
  return static_cast<int>(std::max_element(counts.begin(), counts.end()) - counts.begin());
}

std::vector<RegionReport> measure_regions(std::span<const std::uint8_t> labels, std::span<const float> values,
                                          const Grid& grid, std::span<const std::uint8_t> mask, int regions) {
  std::vector<double> counts(regions, 0), sums = counts, squares = counts;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!takes_part(mask, i)) continue;
    const auto value = static_cast<double>(values[i]);
    counts[labels[i]] += 1;
    sums[labels[i]] += value;
    squares[labels[i]] += value * value;
  }
  const double volume = voxel_volume(grid);
  std::vector<RegionReport> reports(regions);
  for (std::size_t k = 0; k < reports.size(); ++k) {
    RegionReport& report = reports[k];
    report.label = static_cast<int>(k);
    report.voxels = static_cast<Index>(counts[k]);
    report.volume = counts[k] * volume;
    if (counts[k] == 0) continue;
    report.mean = sums[k] / counts[k];
    report.sd = std::sqrt(std::max(0.0, squares[k] / counts[k] - report.mean * report.mean));
  }
  return reports;
}

}  // namespace csrbf
