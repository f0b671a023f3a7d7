#include "csrbf/levelset/convex/potts_contours.hpp"

#include "csrbf/core/parallel_sum.hpp"
#include "csrbf/core/simd.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

constexpr int most_potts_iterations = 200;  // by hand: the labels of the noisiest images stop changing before
constexpr int look_every = 10;              // iterations between two looks at the change
constexpr double at_rest = 1e-4;            // mean change of u per iteration at convergence; by hand
constexpr std::size_t most_labels = 16;
constexpr Index block = 16;  // voxels; rows are as many of these as they need
constexpr Index rows_per_job = 8;

// By rows: the arrays of a label, and those of its neighbours along y and z.
struct PottsRow {
  const float *cost, *ahead, *up, *above;  // of the next rows, or of this one where there are none
  const float *down, *below;               // the dual variables of the rows before, or zeros
  float *u, *extrapolated, *px, *py, *pz;  // pz: null in the plane
};

struct PottsSteps {
  float dual, primal, bound;
  std::array<float, 3> along;
};

CSRBF_ALWAYS_INLINE void ascend_row(const PottsRow& r, Index voxels, const PottsSteps& by) {
  for (Index first = 0; first < voxels; first += block) {
    float right[block], a[block], b[block], c[block] = {};
    for (Index i = 0; i + 1 < block; ++i) right[i] = r.ahead[first + i + 1];
    right[block - 1] = first + block < voxels ? r.ahead[first + block] : 0;
    if (first + block >= voxels) right[voxels - 1 - first] = r.ahead[voxels - 1];
    for (Index i = 0; i < block; ++i) {
      const float here = r.ahead[first + i];
      a[i] = r.px[first + i] + by.dual * by.along[0] * (right[i] - here);
      b[i] = r.py[first + i] + by.dual * by.along[1] * (r.up[first + i] - here);
    }
    if (r.pz != nullptr)
      for (Index i = 0; i < block; ++i)
        c[i] = r.pz[first + i] + by.dual * by.along[2] * (r.above[first + i] - r.ahead[first + i]);
    for (Index i = 0; i < block; ++i) {
      const float scale = by.bound / std::max(by.bound, std::sqrt(a[i] * a[i] + b[i] * b[i] + c[i] * c[i]));
      r.px[first + i] = a[i] * scale;
      r.py[first + i] = b[i] * scale;
      c[i] *= scale;
    }
    if (r.pz != nullptr)
      for (Index i = 0; i < block; ++i) r.pz[first + i] = c[i];
  }
}

// The nearest points with entries >= 0 and sum 1 (Michelot 1986): what is below the common shift no longer counts.
CSRBF_ALWAYS_INLINE void project_to_simplex(float (*x)[block], std::size_t labels) {
  float shift[block], left[block];
  for (Index i = 0; i < block; ++i) {
    shift[i] = -1e30F;
    left[i] = 0;
  }
  for (std::size_t round = 0; round < labels; ++round) {
    float sum[block], count[block], fewer = 0;
    for (Index i = 0; i < block; ++i) sum[i] = count[i] = 0;
    for (std::size_t k = 0; k < labels; ++k)
      for (Index i = 0; i < block; ++i) {
        const float counts = x[k][i] > shift[i] ? 1.0F : 0.0F;
        sum[i] += counts * x[k][i];
        count[i] += counts;
      }
    for (Index i = 0; i < block; ++i) {
      shift[i] = (sum[i] - 1) / count[i];
      fewer = std::max(fewer, std::abs(left[i] - count[i]));
      left[i] = count[i];
    }
    if (fewer == 0) break;
  }
  for (std::size_t k = 0; k < labels; ++k)
    for (Index i = 0; i < block; ++i) x[k][i] = std::max(0.0F, x[k][i] - shift[i]);
}

// Returns the sum of the changes of u.
CSRBF_ALWAYS_INLINE double descend_row(const PottsRow* rows, std::size_t labels, Index voxels, const PottsSteps& by) {
  double sum = 0;
  for (Index first = 0; first < voxels; first += block) {
    float x[most_labels][block], changes[block] = {};
    for (std::size_t k = 0; k < labels; ++k) {
      const PottsRow& r = rows[k];
      float left[block], divergence[block];
      left[0] = first > 0 ? r.px[first - 1] : 0;
      for (Index i = 1; i < block; ++i) left[i] = r.px[first + i - 1];
      for (Index i = 0; i < block; ++i)
        divergence[i] = by.along[0] * (r.px[first + i] - left[i]) + by.along[1] * (r.py[first + i] - r.down[first + i]);
      if (r.pz != nullptr)
        for (Index i = 0; i < block; ++i) divergence[i] += by.along[2] * (r.pz[first + i] - r.below[first + i]);
      for (Index i = 0; i < block; ++i) x[k][i] = r.u[first + i] + by.primal * (divergence[i] - r.cost[first + i]);
    }
    project_to_simplex(x, labels);
    for (std::size_t k = 0; k < labels; ++k) {
      const PottsRow& r = rows[k];
      for (Index i = 0; i < block; ++i) {
        const float before = r.u[first + i];
        changes[i] += std::abs(x[k][i] - before);
        r.extrapolated[first + i] = 2 * x[k][i] - before;
        r.u[first + i] = x[k][i];
      }
    }
    // Where all regions cost the same, as outside a mask, u need not come to rest.
    for (Index i = 0; i < block; ++i)
      sum += rows[0].cost[first + i] != rows[1].cost[first + i] ? static_cast<double>(changes[i]) : 0;
  }
  return sum;
}

// The arrays of a label, in rows of whole blocks.
struct PottsLabel {
  std::vector<float> cost, u, extrapolated, px, py, pz;
};

}  // namespace

int potts_contours(const std::array<Index, 3>& size, const ContourWeight& weight,
                   const std::vector<std::vector<float>>& costs, std::span<std::uint8_t> labels) {
  const std::size_t regions = costs.size();
  const Index nx = size[0], ny = size[1], rows = ny * size[2], length = (nx + block - 1) / block * block;
  double norm = 0;
  for (const double along : weight.along) norm += 4 * along * along;
  const double half = 0.5 * weight.length, root = std::sqrt(norm);
  PottsSteps by{static_cast<float>(half / root), static_cast<float>(1 / (half * root)), static_cast<float>(half), {}};
  for (std::size_t a = 0; a < 3; ++a) by.along[a] = static_cast<float>(weight.along[a]);
  const bool flat = size[2] == 1;
  std::vector<PottsLabel> parts(regions);
  for (std::size_t k = 0; k < regions; ++k) {
    PottsLabel& part = parts[k];
    part.px.assign(static_cast<std::size_t>(length * rows), 0);
    part.py = part.cost = part.px;
    if (!flat) part.pz = part.px;
    part.u.assign(part.px.size(), k == 0 ? 1.0F : 0.0F);
    for (Index row = 0; row < rows; ++row)
      for (Index x = 0; x < nx; ++x) {
        part.u[row * length + x] = labels[row * nx + x] == k ? 1.0F : 0.0F;
        part.cost[row * length + x] = costs[k][row * nx + x];
      }
    part.extrapolated = part.u;
  }
  const std::vector<float> none(static_cast<std::size_t>(length), 0.0F);
  const auto at = [&](PottsLabel& part, Index row) {
    const Index here = row * length, plane = ny * length;
    const bool up = row % ny + 1 < ny, above = row / ny + 1 < size[2], down = row % ny > 0, below = row / ny > 0;
    const float* ahead = part.extrapolated.data() + here;
    return PottsRow{part.cost.data() + here,
                    ahead,
                    up ? ahead + length : ahead,
                    above ? ahead + plane : ahead,
                    down ? part.py.data() + here - length : none.data(),
                    !flat && below ? part.pz.data() + here - plane : none.data(),
                    part.u.data() + here,
                    part.extrapolated.data() + here,
                    part.px.data() + here,
                    part.py.data() + here,
                    flat ? nullptr : part.pz.data() + here};
  };
  int iteration = 0;
  while (iteration < most_potts_iterations) {
    ++iteration;
    parallel_for(rows, rows_per_job, [&](Index begin, Index end) {
      for (Index row = begin; row < end; ++row)
        for (PottsLabel& part : parts) simd<ascend_row>(at(part, row), nx, by);
    });
    const double change = parallel_sum(rows, rows_per_job, [&](Index begin, Index end) {
      double sum = 0;
      std::array<PottsRow, most_labels> all;
      for (Index row = begin; row < end; ++row) {
        for (std::size_t k = 0; k < regions; ++k) all[k] = at(parts[k], row);
        sum += simd<descend_row>(all.data(), regions, nx, by);
      }
      return sum;
    });
    if (iteration % look_every == 0 && change <= at_rest * static_cast<double>(labels.size())) break;
  }
  for (Index row = 0; row < rows; ++row)
    for (Index x = 0; x < nx; ++x) {
      std::size_t best = 0;
      for (std::size_t k = 1; k < regions; ++k)
        if (parts[k].u[row * length + x] > parts[best].u[row * length + x]) best = k;
      labels[row * nx + x] = static_cast<std::uint8_t>(best);
    }
  return iteration;
}

}  // namespace csrbf
