#include "csrbf/levelset/region_cores.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"

#include <mutex>

namespace csrbf {
namespace {

constexpr Index block = 64;  // lines read together, a cache line of them
constexpr Index grain = 1 << 16;

// Takes w voxels at each end of every run of equal labels, but for ends of the line.
void shorten_runs(std::uint8_t* line, Index n, Index w) {
  for (Index begin = 0, end = 0; begin < n; begin = end) {
    const std::uint8_t label = line[begin];
    while (end < n && line[end] == label) ++end;
    if (begin > 0) std::fill(line + begin, line + std::min(end, begin + w), no_region);
    if (end < n) std::fill(line + std::max(begin, end - w), line + end, no_region);
  }
}

// Lines of n labels, `step` apart; the first labels of the lines of a plane are `across` neighbours.
void shorten_strided_runs(std::uint8_t* labels, Index n, Index step, Index across, Index planes, Index w) {
  const Index blocks = (across + block - 1) / block;
  parallel_for(blocks * planes, std::max<Index>(1, grain / (n * block)), [&](Index first, Index last) {
    std::vector<std::uint8_t> copy(static_cast<std::size_t>(n * block));
    for (Index b = first; b < last; ++b) {
      const Index x = b % blocks * block;
      const Index count = std::min(block, across - x);
      std::uint8_t* from = labels + b / blocks * across * n + x;
      for (Index i = 0; i < n; ++i)
        for (Index l = 0; l < count; ++l) copy[static_cast<std::size_t>(l * n + i)] = from[i * step + l];
      for (Index l = 0; l < count; ++l) shorten_runs(copy.data() + l * n, n, w);
      for (Index i = 0; i < n; ++i)
        for (Index l = 0; l < count; ++l) from[i * step + l] = copy[static_cast<std::size_t>(l * n + i)];
    }
  });
}

using Counts = std::array<Index, 256>;

Counts voxels_by_label(std::span<const std::uint8_t> labels) {
  Counts sums{};
  std::mutex mutex;  // sums of integers do not depend on the order
  parallel_for(std::ssize(labels), grain, [&](Index begin, Index end) {
    Counts counts{};
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) ++counts[labels[i]];
    const std::lock_guard lock(mutex);
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += counts[k];
  });
  return sums;
}

// Gives back their voxels to regions that hardly have a core.
void restore_thin_regions(std::span<const std::uint8_t> labels, std::vector<std::uint8_t>& cores) {
  constexpr Index least_share = 10;  // a tenth
  const Counts before = voxels_by_label(labels);
  const Counts after = voxels_by_label(cores);
  std::array<bool, 256> thin{};
  bool any = false;
  for (std::size_t k = 0; k < no_region; ++k) {
    thin[k] = least_share * after[k] < before[k];
    any = any || thin[k];
  }
  if (!any) return;
  parallel_for(std::ssize(labels), grain, [&](Index begin, Index end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
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
    parallel_for(ny * nz, std::max<Index>(1, grain / n), [&](Index begin, Index end) {
      for (Index line = begin; line < end; ++line) shorten_runs(cores.data() + line * n, n, wx);
    });
  }
  if (ny > 1 && wy > 0) shorten_strided_runs(cores.data(), ny, nx, nx, nz, wy);
  if (nz > 1 && wz > 0) shorten_strided_runs(cores.data(), nz, nx * ny, nx * ny, 1, wz);
  restore_thin_regions(labels, cores);
  return cores;
}

}  // namespace csrbf
