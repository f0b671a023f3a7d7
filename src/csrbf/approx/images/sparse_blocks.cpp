#include "csrbf/approx/images/sparse_blocks.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/simd.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace csrbf {
namespace {

constexpr Index lanes = 16;  // blocks that are transformed together

// Along one axis: to[k] = sum_j matrix[k][j] from[j] of vectors of `inner` numbers, a multiple of the lanes.
CSRBF_ALWAYS_INLINE void multiply(const float* matrix, Index n, Index outer, Index inner, const float* from,
                                  float* to) {
  for (Index o = 0; o < outer; ++o, from += n * inner, to += n * inner)
    for (Index i = 0; i < inner; i += lanes) {
      Index k = 0;
      for (; k + 4 <= n; k += 4) {
        float sums[4][lanes] = {};
        for (Index j = 0; j < n; ++j) {
          const float* x = from + j * inner + i;
          const float a = matrix[k * n + j], b = matrix[(k + 1) * n + j];
          const float c = matrix[(k + 2) * n + j], d = matrix[(k + 3) * n + j];
          for (Index l = 0; l < lanes; ++l) {
            sums[0][l] += a * x[l];
            sums[1][l] += b * x[l];
            sums[2][l] += c * x[l];
            sums[3][l] += d * x[l];
          }
        }
        for (Index r = 0; r < 4; ++r)
          for (Index l = 0; l < lanes; ++l) to[(k + r) * inner + i + l] = sums[r][l];
      }
      for (; k < n; ++k) {
        float sum[lanes] = {};
        for (Index j = 0; j < n; ++j)
          for (Index l = 0; l < lanes; ++l) sum[l] += matrix[k * n + j] * from[j * inner + i + l];
        for (Index l = 0; l < lanes; ++l) to[k * inner + i + l] = sum[l];
      }
    }
}

// Sets small coefficients but the first to 0; counts those kept of each lane.
CSRBF_ALWAYS_INLINE void keep_large(float threshold, Index coefficients, float* c, float* kept) {
  for (Index l = 0; l < lanes; ++l) kept[l] = 1;
  for (Index i = 1; i < coefficients; ++i)
    for (Index l = 0; l < lanes; ++l) {
      const float large = std::abs(c[i * lanes + l]) > threshold ? 1.0F : 0.0F;
      c[i * lanes + l] *= large;
      kept[l] += large;
    }
}

// Orthonormal cosines, one per row; `inverse`: one per column.
std::vector<float> cosines(Index n, bool inverse) {
  std::vector<float> matrix(static_cast<std::size_t>(n * n));
  for (Index k = 0; k < n; ++k)
    for (Index j = 0; j < n; ++j) {
      const auto length = static_cast<double>(n);
      const double scale = std::sqrt((k == 0 ? 1 : 2) / length);
      const double angle = std::numbers::pi * static_cast<double>(k) * (static_cast<double>(j) + 0.5) / length;
      matrix[inverse ? j * n + k : k * n + j] = static_cast<float>(scale * std::cos(angle));
    }
  return matrix;
}

class Refinement {
 public:
  Refinement(std::span<float> values, std::span<const std::uint8_t> unknown, const std::array<Index, 3>& size,
             const SparseBlocks& options)
      : values_(values), unknown_(unknown), size_(size), sums_(values.size()), weights_(values.size()) {
    for (std::size_t a = 0; a < 3; ++a) {
      width_[a] = std::min(options.width, size[a]);
      step_[a] = std::clamp<Index>(width_[a] / 2, 1, options.step);
      forward_[a] = cosines(width_[a], false);
      inverse_[a] = cosines(width_[a], true);
    }
    count_unknown();
  }

  void run(float threshold, Index shift) {
    std::fill(sums_.begin(), sums_.end(), 0.0F);
    std::fill(weights_.begin(), weights_.end(), 0.0F);
    for (std::size_t a = 0; a < 3; ++a) begin_[a] = first_block(a, shift);
    // Blocks of one strip reach at most into the next one.
    const std::size_t along = size_[2] > 1 ? 2 : 1;
    const Index rows = blocks(along), strip = (width_[along] + step_[along] - 1) / step_[along],
                strips = (rows + strip - 1) / strip;
    for (const Index parity : {0, 1})
      parallel_for((strips + 1 - parity) / 2, 1, [&](Index begin, Index end) {
        for (Index s = begin; s < end; ++s)
          add_rows(along, (2 * s + parity) * strip, std::min(rows, (2 * s + parity + 1) * strip), threshold);
      });
    for (std::size_t i = 0; i < values_.size(); ++i)
      if (unknown_[i] != 0 && weights_[i] > 0) values_[i] = sums_[i] / weights_[i];
  }

 private:
  using Place = std::array<Index, 3>;

  // Of every axis the first block ends after voxel 0.
  [[nodiscard]] Index first_block(std::size_t a, Index shift) const {
    if (width_[a] == 1) return 0;
    for (std::size_t b = 0; b < a; ++b) shift /= step_[b];
    return 1 - width_[a] + shift % step_[a];
  }
  [[nodiscard]] Index blocks(std::size_t a) const { return (size_[a] - 1 - begin_[a]) / step_[a] + 1; }
  [[nodiscard]] Index place(std::size_t a, Index block) const { return begin_[a] + block * step_[a]; }

  // Of all voxels before each one along all axes.
  void count_unknown() {
    const Index nx = size_[0] + 1, ny = size_[1] + 1;
    before_.assign(static_cast<std::size_t>(nx * ny * (size_[2] + 1)), 0);
    for (Index z = 0; z < size_[2]; ++z)
      for (Index y = 0; y < size_[1]; ++y) {
        Index row = 0;
        for (Index x = 0; x < size_[0]; ++x) {
          row += unknown_[(z * size_[1] + y) * size_[0] + x] != 0 ? 1 : 0;
          const Index i = ((z + 1) * ny + y + 1) * nx + x + 1;
          before_[i] = row + before_[i - nx] + before_[i - nx * ny] - before_[i - nx - nx * ny];
        }
      }
  }

  [[nodiscard]] bool has_unknown(const Place& at) const {
    Place lo, hi;
    for (std::size_t a = 0; a < 3; ++a) {
      lo[a] = std::max<Index>(at[a], 0);
      hi[a] = std::min(at[a] + width_[a], size_[a]);
    }
    const auto sum = [&](Index x, Index y, Index z) { return before_[(z * (size_[1] + 1) + y) * (size_[0] + 1) + x]; };
    const auto slab = [&](Index z) {
      return sum(hi[0], hi[1], z) - sum(lo[0], hi[1], z) - sum(hi[0], lo[1], z) + sum(lo[0], lo[1], z);
    };
    return slab(hi[2]) > slab(lo[2]);
  }

  void add_rows(std::size_t along, Index first, Index last, float threshold) {
    const Index voxels = width_[0] * width_[1] * width_[2];
    std::vector<float> c(static_cast<std::size_t>(voxels * lanes), 0.0F), scratch = c;
    std::vector<Place> batch;
    const auto add = [&](const Place& at) {
      if (has_unknown(at)) batch.push_back(at);
      if (std::ssize(batch) < lanes) return;
      add_batch(batch, threshold, c, scratch);
      batch.clear();
    };
    for (Index row = first; row < last; ++row)
      for (Index j = 0, n = along == 2 ? blocks(1) : blocks(2); j < n; ++j)
        for (Index i = 0; i < blocks(0); ++i)
          add({place(0, i), place(1, along == 2 ? j : row), place(2, along == 2 ? row : j)});
    if (!batch.empty()) add_batch(batch, threshold, c, scratch);
  }

  // What the large coefficients of these blocks say.
  void add_batch(const std::vector<Place>& batch, float threshold, std::vector<float>& c, std::vector<float>& scratch) {
    for (std::size_t l = 0; l < batch.size(); ++l)
      for_voxels(batch[l], [&](Index i, Index voxel, bool /*inside*/) { c[i * lanes + l] = values_[voxel]; });
    transform(forward_, c, scratch);
    float kept[lanes];
    simd<keep_large>(threshold, std::ssize(c) / lanes, c.data(), kept);
    transform(inverse_, c, scratch);
    for (std::size_t l = 0; l < batch.size(); ++l) {
      const float weight = 1 / kept[l];
      for_voxels(batch[l], [&](Index i, Index voxel, bool inside) {
        if (!inside || unknown_[voxel] == 0) return;
        sums_[voxel] += weight * c[i * lanes + l];
        weights_[voxel] += weight;
      });
    }
  }

  void transform(const std::array<std::vector<float>, 3>& matrix, std::vector<float>& c,
                 std::vector<float>& scratch) const {
    Index inner = lanes, outer = std::ssize(c) / lanes;
    for (std::size_t a = 0; a < 3; ++a) {
      outer /= width_[a];
      if (width_[a] > 1) {
        simd<multiply>(matrix[a].data(), width_[a], outer, inner, c.data(), scratch.data());
        c.swap(scratch);
      }
      inner *= width_[a];
    }
  }

  // The voxels of a block; outside the image those mirrored at its border.
  template <class Visit>
  void for_voxels(const Place& at, const Visit& visit) const {
    const auto mirrored = [&](std::size_t a, Index i) {
      if (i < 0) return -i;
      return i >= size_[a] ? 2 * size_[a] - 2 - i : i;
    };
    Index i = 0;
    for (Index z = at[2]; z < at[2] + width_[2]; ++z)
      for (Index y = at[1]; y < at[1] + width_[1]; ++y) {
        const Index my = mirrored(1, y), mz = mirrored(2, z), row = (mz * size_[1] + my) * size_[0];
        const bool inside = my == y && mz == z;
        for (Index x = at[0]; x < at[0] + width_[0]; ++x, ++i) {
          const Index mx = mirrored(0, x);
          visit(i, row + mx, inside && mx == x);
        }
      }
  }

  std::span<float> values_;
  std::span<const std::uint8_t> unknown_;
  std::array<Index, 3> size_, width_{}, step_{}, begin_{};
  std::array<std::vector<float>, 3> forward_, inverse_;
  std::vector<Index> before_;
  std::vector<float> sums_, weights_;
};

}  // namespace

void refine_by_sparse_blocks(std::span<float> values, std::span<const std::uint8_t> unknown,
                             const std::array<Index, 3>& size, const SparseBlocks& options) {
  Refinement refinement(values, unknown, size, options);
  for (int round = 0; round < options.rounds; ++round) {
    const double t = options.rounds > 1 ? static_cast<double>(round) / (options.rounds - 1) : 1;
    const double threshold = options.first_threshold * std::pow(options.last_threshold / options.first_threshold, t);
    refinement.run(static_cast<float>(threshold), round);
  }
}

}  // namespace csrbf
