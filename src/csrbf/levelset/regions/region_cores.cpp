#include "csrbf/levelset/regions/region_cores.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/simd.hpp"

#include <mutex>

namespace csrbf {
namespace {

constexpr Index block = 256;           // lines taken together: their distances stay in the first cache
constexpr Index core_grain = 1 << 16;  // voxels per task

// Takes w voxels at each end of every run of equal labels, but for ends of the line.
void shorten_runs(std::uint8_t* line, Index n, Index w) {
  for (Index begin = 0, end = 0; begin < n; begin = end) {
    const std::uint8_t label = line[begin];
    while (end < n && line[end] == label) ++end;
    if (begin > 0) std::fill(line + begin, line + std::min(end, begin + w), no_region);
    if (end < n) std::fill(line + std::max(begin, end - w), line + end, no_region);
  }
}

// The same for up to `block` neighbouring lines of n labels, `step` apart, from one array to another: a voxel is left
// when the last and the next change along its line are at least w away.
CSRBF_ALWAYS_INLINE void shorten_runs_of_lines(const std::uint8_t* __restrict from, Index n, Index step, Index count,
                                               std::uint16_t w, std::uint8_t* __restrict to) {
  constexpr std::uint16_t far = std::numeric_limits<std::uint16_t>::max();
  std::uint16_t distance[block];
  const auto next = [](std::uint16_t d) { return static_cast<std::uint16_t>(d + (d < far ? 1 : 0)); };
  std::fill(distance, distance + block, far);
  for (Index i = 0; i < n; ++i) {
    const std::uint8_t* label = from + i * step;
    const std::uint8_t* before = i > 0 ? label - step : label;
    for (Index l = 0; l < count; ++l) {
      distance[l] = label[l] == before[l] ? next(distance[l]) : std::uint16_t{0};
      to[i * step + l] = distance[l] < w ? no_region : label[l];
    }
  }
  std::fill(distance, distance + block, far);
  for (Index i = n - 1; i >= 0; --i) {
    const std::uint8_t* label = from + i * step;
    const std::uint8_t* after = i + 1 < n ? label + step : label;
    for (Index l = 0; l < count; ++l) {
      distance[l] = label[l] == after[l] ? next(distance[l]) : std::uint16_t{0};
      to[i * step + l] = distance[l] < w ? no_region : to[i * step + l];
    }
  }
}

// Lines of n labels, `step` apart; the first labels of the lines of a plane are `across` neighbours.
void shorten_strided_runs(std::vector<std::uint8_t>& labels, Index n, Index step, Index across, Index planes, Index w) {
  const auto width = static_cast<std::uint16_t>(std::min<Index>(w, std::numeric_limits<std::uint16_t>::max()));
  std::vector<std::uint8_t> result(labels.size());
  const Index blocks = (across + block - 1) / block;
  parallel_for(blocks * planes, std::max<Index>(1, core_grain / (n * block)), [&](Index first, Index last) {
    for (Index b = first; b < last; ++b) {
      const Index x = b % blocks * block;
      const Index offset = b / blocks * across * n + x;
      simd<shorten_runs_of_lines>(labels.data() + offset, n, step, std::min(block, across - x), width,
                                  result.data() + offset);
    }
  });
  labels.swap(result);
}

using Counts = std::array<Index, 256>;

Counts voxels_by_label(std::span<const std::uint8_t> labels) {
  Counts sums{};
  std::mutex mutex;  // sums of integers do not depend on the order
  parallel_for(std::ssize(labels), core_grain, [&](Index begin, Index end) {
    // Neighbours in different copies: an increment waits for the one before of the same label.
    std::array<Counts, 4> counts{};
    for (Index i = begin; i < end; ++i) ++counts[i % 4][labels[i]];
    const std::lock_guard lock(mutex);
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += counts[0][k] + counts[1][k] + counts[2][k] + counts[3][k];
  });
  return sums;
}

// Gives back their voxels to regions that hardly have a core.
void restore_thin_regions(std::span<const std::uint8_t> labels, std::vector<std::uint8_t>& cores) {
  constexpr Index least_share = 10;  // a tenth of the voxels, inverted; by hand: fewer do not represent a region
  const Counts before = voxels_by_label(labels);
  const Counts after = voxels_by_label(cores);
  std::array<bool, 256> thin{};
  bool any = false;
  for (std::size_t k = 0; k < no_region; ++k) {
    thin[k] = least_share * after[k] < before[k];
    any = any || thin[k];
  }
  if (!any) return;
  parallel_for(std::ssize(labels), core_grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      if (thin[labels[i]]) cores[i] = labels[i];
  });
}

}  // namespace

std::vector<std::uint8_t> region_cores(std::span<const std::uint8_t> labels, const std::array<Index, 3>& size,
                                       const std::array<Index, 3>& half_width) {
  const auto [nx, ny, nz] = size;
  require(nx >= 0 && ny >= 0 && nz >= 0 && nx * ny * nz == std::ssize(labels), "region_cores", "labels.size()",
          labels.size(), "must be the product of the sizes along the axes");
  for (const Index w : half_width) require(w >= 0, "region_cores", "half_width", w, "must not be negative");
  std::vector<std::uint8_t> cores(labels.begin(), labels.end());
  if (cores.empty()) return cores;
  const Index wx = std::min(half_width[0], nx);  // a run is never longer than its line
  const Index wy = std::min(half_width[1], ny);
  const Index wz = std::min(half_width[2], nz);
  if (nx > 1 && wx > 0) {
    const Index n = nx;
    parallel_for(ny * nz, std::max<Index>(1, core_grain / n), [&](Index begin, Index end) {
      for (Index line = begin; line < end; ++line) shorten_runs(cores.data() + line * n, n, wx);
    });
  }
  if (ny > 1 && wy > 0) shorten_strided_runs(cores, ny, nx, nx, nz, wy);
  if (nz > 1 && wz > 0) shorten_strided_runs(cores, nz, nx * ny, nx * ny, 1, wz);
  restore_thin_regions(labels, cores);
  return cores;
}

}  // namespace csrbf
