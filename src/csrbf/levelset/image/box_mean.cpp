#include "csrbf/levelset/image/box_mean.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/simd.hpp"

#include <vector>

namespace csrbf {
namespace {

constexpr int block = 32;  // lines filtered together: as many running sums as vector code wants

// Lines of n values; value i of line l is at i * step + l * line_step.
struct Lines {
  Index n = 0;
  Index step = 1;
  Index line_step = 1;
};

// A block of `count` <= `block` lines starting at `values`; `copy` is work space for n * block values.
CSRBF_ALWAYS_INLINE void filter_lines(float* values, const Lines& lines, int count, Index w, float* copy) {
  const Index n = lines.n;
  for (Index i = 0; i < n; ++i)
    for (int l = 0; l < block; ++l) copy[i * block + l] = l < count ? values[i * lines.step + l * lines.line_step] : 0;

  double sum[block] = {};
  for (Index i = 0; i < std::min(w, n); ++i)
    for (int l = 0; l < block; ++l) sum[l] += static_cast<double>(copy[i * block + l]);
  for (Index i = 0; i < n; ++i) {
    const Index first = std::max<Index>(0, i - w);
    const Index last = std::min(n - 1, i + w);
    if (i + w < n)
      for (int l = 0; l < block; ++l) sum[l] += static_cast<double>(copy[last * block + l]);
    const double scale = 1 / static_cast<double>(last - first + 1);
    float mean[block];
    for (int l = 0; l < block; ++l) mean[l] = static_cast<float>(sum[l] * scale);
    if (i - w >= 0)
      for (int l = 0; l < block; ++l) sum[l] -= static_cast<double>(copy[first * block + l]);
    for (int l = 0; l < count; ++l) values[i * lines.step + l * lines.line_step] = mean[l];
  }
}

// All lines of a plane: `across` of them, line_step apart, for each of `planes` planes, plane_step apart.
void filter_axis(float* values, const Lines& lines, Index across, Index planes, Index plane_step, Index w) {
  const Index blocks = (across + block - 1) / block;
  const Index grain = std::max<Index>(1, (1 << 16) / (lines.n * block));
  parallel_for(blocks * planes, grain, [&](Index begin, Index end) {
    std::vector<float> copy(lines.n * block);
    for (Index b = begin; b < end; ++b) {
      const Index line = b % blocks * block;
      float* first = values + b / blocks * plane_step + line * lines.line_step;
      simd<filter_lines>(first, lines, static_cast<int>(std::min<Index>(block, across - line)), w, copy.data());
    }
  });
}

}  // namespace

void box_mean(std::span<float> values, const std::array<Index, 3>& size, const std::array<Index, 3>& half_width) {
  const auto [nx, ny, nz] = size;
  require(nx >= 0 && ny >= 0 && nz >= 0 && nx * ny * nz == std::ssize(values), "box_mean", "values.size()",
          values.size(), "must be the product of the sizes along the axes");
  for (const Index w : half_width) require(w >= 0, "box_mean", "half_width", w, "must not be negative");
  if (values.empty()) return;
  const auto width = [&](int axis) {  // beyond the image nothing is added
    return std::min(half_width[axis], size[axis]);
  };
  float* v = values.data();
  if (nx > 1 && width(0) > 0) filter_axis(v, {nx, 1, nx}, ny * nz, 1, 0, width(0));
  if (ny > 1 && width(1) > 0) filter_axis(v, {ny, nx, 1}, nx, nz, nx * ny, width(1));
  if (nz > 1 && width(2) > 0) filter_axis(v, {nz, nx * ny, 1}, nx * ny, 1, 0, width(2));
}

}  // namespace csrbf
