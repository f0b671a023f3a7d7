#include "csrbf/levelset/partition/potts_contours.hpp"

#include "csrbf/core/parallel_sum.hpp"

namespace csrbf {
namespace {

constexpr int most_potts_iterations = 200;  // by hand: the labels of the noisiest images stop changing before
constexpr int look_every = 10;              // iterations between two looks at the change
constexpr double at_rest = 1e-4;            // mean change of u per iteration at convergence; by hand
constexpr std::size_t most_labels = 16;

// The nearest point with entries >= 0 and sum 1.
void project_to_simplex(float* x, std::size_t n) {
  std::array<float, most_labels> sorted{};
  std::copy_n(x, n, sorted.begin());
  std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(n), std::greater<>());
  float sum = 0, shift = 0;
  for (std::size_t k = 0; k < n; ++k) {
    sum += sorted[k];
    const float candidate = (sum - 1) / static_cast<float>(k + 1);
    if (sorted[k] > candidate) shift = candidate;
  }
  for (std::size_t k = 0; k < n; ++k) x[k] = std::max(0.0F, x[k] - shift);
}

struct Region {
  std::vector<float> u, extrapolated, px, py, pz;
};

}  // namespace

int potts_contours(const std::array<Index, 3>& size, const ContourWeight& weight,
                   const std::vector<std::vector<float>>& costs, std::span<std::uint8_t> labels) {
  const std::size_t regions = costs.size(), voxels = labels.size();
  const Index nx = size[0], nxy = nx * size[1], rows = size[1] * size[2];
  double norm = 0;
  for (const double along : weight.along) norm += 4 * along * along;
  const double length = 0.5 * weight.length, root = std::sqrt(norm);
  const auto dual = static_cast<float>(length / root), primal = static_cast<float>(1 / (length * root));
  const auto bound = static_cast<float>(length);
  std::array<float, 3> along{};
  for (std::size_t a = 0; a < 3; ++a) along[a] = static_cast<float>(weight.along[a]);
  const bool flat = size[2] == 1;
  std::vector<Region> parts(regions);
  for (std::size_t k = 0; k < regions; ++k) {
    Region& r = parts[k];
    r.u.resize(voxels);
    for (std::size_t i = 0; i < voxels; ++i) r.u[i] = labels[i] == k ? 1.0F : 0.0F;
    r.extrapolated = r.u;
    r.px.assign(voxels, 0);
    r.py = r.px;
    if (!flat) r.pz = r.px;
  }
  const auto ascend = [&](Region& r, Index row) {
    const bool y = row % size[1] + 1 < size[1], z = row / size[1] + 1 < size[2];
    const float* u = r.extrapolated.data();
    for (Index i = row * nx, end = i + nx; i < end; ++i) {
      const float a = r.px[i] + (i + 1 < end ? dual * along[0] * (u[i + 1] - u[i]) : 0);
      const float b = r.py[i] + (y ? dual * along[1] * (u[i + nx] - u[i]) : 0);
      const float c = flat ? 0 : r.pz[i] + (z ? dual * along[2] * (u[i + nxy] - u[i]) : 0);
      const float scale = bound / std::max(bound, std::sqrt(a * a + b * b + c * c));
      r.px[i] = a * scale;
      r.py[i] = b * scale;
      if (!flat) r.pz[i] = c * scale;
    }
  };
  const auto descend = [&](Index row) {
    const bool y = row % size[1] > 0, z = row / size[1] > 0;
    double change = 0;
    std::array<float, most_labels> x{};
    for (Index i = row * nx, end = i + nx; i < end; ++i) {
      for (std::size_t k = 0; k < regions; ++k) {
        const Region& r = parts[k];
        float divergence = along[0] * (r.px[i] - (i > row * nx ? r.px[i - 1] : 0));
        divergence += along[1] * (r.py[i] - (y ? r.py[i - nx] : 0));
        if (!flat) divergence += along[2] * (r.pz[i] - (z ? r.pz[i - nxy] : 0));
        x[k] = r.u[i] + primal * (divergence - costs[k][static_cast<std::size_t>(i)]);
      }
      project_to_simplex(x.data(), regions);
      // Where all regions cost the same, as outside a mask, u need not come to rest.
      const double counts = costs[0][static_cast<std::size_t>(i)] != costs[1][static_cast<std::size_t>(i)] ? 1 : 0;
      for (std::size_t k = 0; k < regions; ++k) {
        Region& r = parts[k];
        change += counts * static_cast<double>(std::abs(x[k] - r.u[i]));
        r.extrapolated[i] = 2 * x[k] - r.u[i];
        r.u[i] = x[k];
      }
    }
    return change;
  };
  int iteration = 0;
  while (iteration < most_potts_iterations) {
    ++iteration;
    parallel_for(rows, 8, [&](Index begin, Index end) {
      for (Index row = begin; row < end; ++row)
        for (Region& r : parts) ascend(r, row);
    });
    const double change = parallel_sum(rows, 8, [&](Index begin, Index end) {
      double sum = 0;
      for (Index row = begin; row < end; ++row) sum += descend(row);
      return sum;
    });
    if (iteration % look_every == 0 && change <= at_rest * static_cast<double>(voxels)) break;
  }
  for (std::size_t i = 0; i < voxels; ++i) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < regions; ++k)
      if (parts[k].u[i] > parts[best].u[i]) best = k;
    labels[i] = static_cast<std::uint8_t>(best);
  }
  return iteration;
}

}  // namespace csrbf
