#include "csrbf/levelset/image/gaussian_blur.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/simd.hpp"

#include <vector>

namespace csrbf {
namespace {

constexpr Index blurred_block = 32;  // lines filtered together: as many sums as vector code wants

// Weights of the offsets -reach to reach.
std::vector<float> gaussian_weights(double sd) {
  const auto reach = static_cast<Index>(std::ceil(4 * sd));  // leaves out 6e-5 of the weight
  std::vector<float> weights;
  double sum = 0;
  for (Index k = -reach; k <= reach; ++k) sum += std::exp(-0.5 * static_cast<double>(k * k) / (sd * sd));
  for (Index k = -reach; k <= reach; ++k)
    weights.push_back(static_cast<float>(std::exp(-0.5 * static_cast<double>(k * k) / (sd * sd)) / sum));
  return weights;
}

// Place of voxel i of a line that is mirrored at the outer faces of its first and last voxel, again and again.
Index mirrored(Index i, Index n) {
  i %= 2 * n;
  if (i < 0) i += 2 * n;
  return i < n ? i : 2 * n - 1 - i;
}

// out[l] = sum of weights[k] in[k * block + l]
CSRBF_ALWAYS_INLINE void sum_lines(const float* weights, Index count, const float* in, float* out) {
  float sum[blurred_block] = {};
  for (Index k = 0; k < count; ++k)
    for (Index l = 0; l < blurred_block; ++l) sum[l] += weights[k] * in[k * blurred_block + l];
  for (Index l = 0; l < blurred_block; ++l) out[l] = sum[l];
}

// Value i of line l of the n-voxel lines of an axis is at values[i * step + l * line_step].
struct BlurredLines {
  Index n, step, line_step, across, planes, plane_step;
};

void blur_axis(float* values, const BlurredLines& lines, double sd) {
  const std::vector<float> weights = gaussian_weights(sd);
  const auto count = std::ssize(weights);
  const Index reach = count / 2, blocks = (lines.across + blurred_block - 1) / blurred_block;
  parallel_for(
      blocks * lines.planes, std::max<Index>(1, (1 << 16) / (lines.n * blurred_block)), [&](Index begin, Index end) {
        std::vector<float> copy((lines.n + 2 * reach) * blurred_block, 0.0F);
        std::array<float, blurred_block> sums;
        for (Index b = begin; b < end; ++b) {
          const Index line = b % blocks * blurred_block, used = std::min(blurred_block, lines.across - line);
          float* first = values + b / blocks * lines.plane_step + line * lines.line_step;
          for (Index i = -reach; i < lines.n + reach; ++i)
            for (Index l = 0; l < used; ++l)
              copy[(i + reach) * blurred_block + l] = first[mirrored(i, lines.n) * lines.step + l * lines.line_step];
          for (Index i = 0; i < lines.n; ++i) {
            simd<sum_lines>(weights.data(), count, copy.data() + i * blurred_block, sums.data());
            for (Index l = 0; l < used; ++l) first[i * lines.step + l * lines.line_step] = sums[l];
          }
        }
      });
}

}  // namespace

void gaussian_blur(std::span<float> values, const std::array<Index, 3>& size, const std::array<double, 3>& sd) {
  const auto [nx, ny, nz] = size;
  require(nx >= 0 && ny >= 0 && nz >= 0 && nx * ny * nz == std::ssize(values), "gaussian_blur", "values.size()",
          values.size(), "must be the product of the sizes along the axes");
  for (const double s : sd) require(s >= 0 && std::isfinite(s), "gaussian_blur", "sd", s, "must not be negative");
  if (values.empty()) return;
  float* v = values.data();
  if (nx > 1 && sd[0] > 0) blur_axis(v, {nx, 1, nx, ny * nz, 1, 0}, sd[0]);
  if (ny > 1 && sd[1] > 0) blur_axis(v, {ny, nx, 1, nx, nz, nx * ny}, sd[1]);
  if (nz > 1 && sd[2] > 0) blur_axis(v, {nz, nx * ny, 1, nx * ny, 1, 0}, sd[2]);
}

}  // namespace csrbf
