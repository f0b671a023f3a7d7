#include "csrbf/levelset/objects/seams.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"
#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "csrbf/levelset/objects/distance_basins.hpp"
#include "csrbf/levelset/objects/voxel_neighbours.hpp"
#include "csrbf/spatial/distance_transform.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

constexpr double seam_width = 1.5;          // voxels, of the Gaussian
constexpr double beyond_noise = 5;          // deviations of the curvature
constexpr double least_bend = 0.05;         // of the contrast; by hand: less takes textures for seams
constexpr double off_valley = 1;            // voxels
constexpr double deep_inside = 2;           // voxels
constexpr double usual_range = 3;           // contrasts: gross errors lie beyond
constexpr std::ptrdiff_t judged = 1 << 17;  // values at most

using Voxel = std::array<Index, 3>;

Voxel voxel_at(Index i, const Grid& grid) {
  return {i % grid.size[0], i / grid.size[0] % grid.size[1], i / (grid.size[0] * grid.size[1])};
}

double shortest_spacing(const Grid& grid) {
  double shortest = grid.spacing.x();
  for (int a = 0; a < 3; ++a)
    if (grid.size[a] > 1) shortest = std::min(shortest, grid.spacing[a]);
  return shortest;
}

template <class Wanted>
double median_where(std::span<const float> values, const Wanted& wanted) {
  std::vector<float> some;
  const std::ptrdiff_t step = 1 + std::ssize(values) / judged;
  for (std::ptrdiff_t i = 0; i < std::ssize(values); i += step)
    if (wanted(i) && std::isfinite(values[i])) some.push_back(values[i]);
  return some.empty() ? std::nan("") : static_cast<double>(median(some));
}

// Of second differences along x inside, where noise may be more than outside.
double noise_inside(std::span<const float> values, const std::vector<std::uint8_t>& inside, const Grid& grid) {
  std::vector<float> differences;
  const Index nx = grid.size[0], step = 1 + std::ssize(values) / judged;
  for (Index i = 1; i + 1 < std::ssize(values); i += step) {
    if (i % nx == 0 || i % nx + 1 == nx || inside[i - 1] == 0 || inside[i] == 0 || inside[i + 1] == 0) continue;
    differences.push_back(std::abs(values[i - 1] - 2 * values[i] + values[i + 1]));
  }
  return differences.empty() ? 0 : static_cast<double>(median(differences)) / median_of_normal / std::sqrt(6.0);
}

// Sums of squares of a Gaussian along one axis and of its second differences: what they leave of the variance of noise.
std::array<double, 2> noise_left(double sd) {
  std::vector<float> impulse(65, 0.0F);
  impulse[32] = 1;
  gaussian_blur(impulse, {65, 1, 1}, {sd, 0, 0});
  std::array<double, 2> sums{0, 0};
  for (std::size_t i = 1; i + 1 < impulse.size(); ++i) {
    const double value = static_cast<double>(impulse[i]);
    const double bend = static_cast<double>(impulse[i - 1] - 2 * impulse[i] + impulse[i + 1]);
    sums[0] += value * value;
    sums[1] += bend * bend;
  }
  return sums;
}

// Slopes and curvatures of an image per voxel of the shortest side.
class Valleys {
 public:
  Valleys(std::span<const float> values, const Grid& grid) : values_(values), grid_(grid) {
    for (std::size_t a = 0; a < 3; ++a) {
      strides_[a] = a == 0 ? 1 : strides_[a - 1] * grid.size[a - 1];
      length_[a] = grid.spacing[static_cast<int>(a)] / shortest_spacing(grid);
      if (grid.size[a] > 2) axes_.push_back(a);
    }
  }

  // Whether the curvature is more than `least` in some direction, in which the image is least here.
  [[nodiscard]] bool is_one(Index i, double least) const {
    const int dim = static_cast<int>(axes_.size());
    const Voxel at = voxel_at(i, grid_);
    for (const std::size_t a : axes_)
      if (at[a] == 0 || at[a] + 1 == grid_.size[a]) return false;
    SmallVector slope(dim);
    SmallMatrix bend(dim, dim);
    double sum = 0;
    for (int k = 0; k < dim; ++k) {
      const std::size_t a = axes_[static_cast<std::size_t>(k)];
      const double before = value(i - strides_[a]), after = value(i + strides_[a]);
      slope[k] = (after - before) / (2 * length_[a]);
      bend(k, k) = (before - 2 * value(i) + after) / (length_[a] * length_[a]);
      sum += bend(k, k) * bend(k, k);
      for (int j = 0; j < k; ++j) {
        const std::size_t b = axes_[static_cast<std::size_t>(j)];
        const Index s = strides_[a], t = strides_[b];
        bend(k, j) = bend(j, k) =
            (value(i + s + t) - value(i + s - t) - value(i - s + t) + value(i - s - t)) / (4 * length_[a] * length_[b]);
        sum += 2 * bend(k, j) * bend(k, j);
      }
    }
    if (!(sum > least * least)) return false;  // no eigenvalue is larger
    const SymmetricEigen found = symmetric_eigen_direct(bend);
    const double most = found.values[dim - 1];
    return most > least && std::abs(slope.dot(found.vectors.col(dim - 1))) <= off_valley * most;
  }

 private:
  [[nodiscard]] double value(Index i) const { return static_cast<double>(values_[i]); }

  std::span<const float> values_;
  const Grid& grid_;
  std::array<Index, 3> strides_{};
  std::array<double, 3> length_{};
  std::vector<std::size_t> axes_;
};

// The mean of the components, brighter inside than outside, within the usual range; and the contrast.
double gather_brightness(const Volume<float>& image, const std::vector<std::uint8_t>& inside,
                         std::vector<float>& values) {
  values.resize(inside.size());
  const Index components = image.components;
  for (Index i = 0; i < std::ssize(values); ++i) {
    float sum = 0;
    for (Index c = 0; c < components; ++c) sum += image.values[i * components + c];
    values[i] = sum / static_cast<float>(components);
  }
  const double in = median_where(values, [&](std::ptrdiff_t i) { return inside[i] != 0; });
  const double out = median_where(values, [&](std::ptrdiff_t i) { return inside[i] == 0; });
  const double contrast = std::abs(in - out);
  if (!(contrast > 0 && std::isfinite(contrast))) return 0;
  const auto lowest = static_cast<float>(std::min(in, out) - usual_range * contrast);
  const auto highest = static_cast<float>(std::max(in, out) + usual_range * contrast);
  for (float& value : values) {
    value = std::isfinite(value) ? std::clamp(value, lowest, highest) : static_cast<float>(out);
    if (in < out) value = -value;
  }
  return contrast;
}

}  // namespace

std::vector<std::uint8_t> find_seams(const Volume<float>& image, const std::vector<std::uint8_t>& inside) {
  const Grid& grid = image.grid;
  std::vector<std::uint8_t> seams(inside.size(), 0);
  std::vector<float> values;
  const double contrast = gather_brightness(image, inside, values);
  if (!(contrast > 0)) return seams;
  std::array<double, 3> sd{};
  double variance = std::pow(noise_inside(values, inside, grid), 2), across = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (grid.size[a] == 1) continue;
    sd[a] = seam_width * shortest_spacing(grid) / grid.spacing[static_cast<int>(a)];
    const auto [kept, bent] = noise_left(sd[a]);
    variance *= kept;
    const double length = grid.spacing[static_cast<int>(a)] / shortest_spacing(grid);  // as curvatures are measured
    across = std::max(across, bent / kept / std::pow(length, 4));
  }
  gaussian_blur(values, grid.size, sd);
  const double least = std::max(least_bend * contrast, beyond_noise * std::sqrt(variance * across));
  const Valleys valleys(values, grid);
  parallel_for(std::ssize(inside), 1 << 12, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) seams[i] = inside[i] != 0 && valleys.is_one(i, least) ? 1 : 0;
  });
  return seams;
}

std::vector<std::int32_t> basins_between(const std::vector<std::uint8_t>& seams,
                                         const std::vector<std::uint8_t>& inside, const Grid& grid) {
  std::vector<std::uint8_t> between(inside.size());
  for (std::size_t i = 0; i < inside.size(); ++i) between[i] = inside[i] != 0 && seams[i] == 0 ? 1 : 0;
  std::vector<std::int32_t> labels = distance_basins(between, grid);
  std::vector<Index> front;
  for (Index i = 0; i < std::ssize(labels); ++i)
    if (labels[i] != 0) front.push_back(i);
  while (!front.empty()) {
    std::vector<Index> next;
    for (const Index i : front)
      for_neighbours(i, grid, [&](Index j) {
        if (inside[j] == 0 || labels[j] != 0) return;
        labels[j] = labels[i];
        next.push_back(j);
      });
    front = std::move(next);
  }
  return labels;
}

void keep_deep(std::vector<std::uint8_t>& seams, const std::vector<std::uint8_t>& inside, const Grid& grid) {
  std::vector<std::uint8_t> outside(inside.size());
  for (std::size_t i = 0; i < outside.size(); ++i) outside[i] = inside[i] == 0 ? 1 : 0;
  const std::vector<float> depth = distance_transform(grid.size, grid.spacing, outside);
  const auto deep = static_cast<float>(deep_inside * shortest_spacing(grid));
  for (std::size_t i = 0; i < seams.size(); ++i)
    if (!(depth[i] > deep)) seams[i] = 0;
}

bool is_at_border(std::span<const std::int32_t> labels, Index voxel, const Grid& grid) {
  const auto differ = [&](Index i, Index j) { return labels[j] != 0 && labels[i] != labels[j]; };
  return any_neighbour(voxel, grid, [&](Index i) {
    return differ(voxel, i) || (labels[i] != 0 && any_neighbour(i, grid, [&](Index j) { return differ(i, j); }));
  });
}

}  // namespace csrbf
