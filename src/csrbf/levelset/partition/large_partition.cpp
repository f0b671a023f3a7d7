#include "csrbf/levelset/partition/large_partition.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/levelset/contour/contour_energy.hpp"
#include "csrbf/levelset/image/block_means.hpp"
#include "csrbf/levelset/regions/intensity_classes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

constexpr Index most_blocks = 1 << 21;
constexpr Index small_blocks = 1 << 24;  // for the start: of about 2 x 2 x 2 voxels in a volume of 512^3
constexpr double most_noise = 0.3;       // deviation over the contrast: the mean of neighbours does not suffice in more
constexpr float side_weight = 0.36F;     // of neighbours along an axis: a Gaussian of 0.7 voxels
constexpr int most_turns = 5;            // of means and contours; by hand: most end after 2 or 3
constexpr double means_at_rest = 1e-4;   // change of the means, over their contrast, at the end; by hand
constexpr int fit_steps = 8;             // of conjugate gradients for the level set; by hand: more change no voxel
constexpr Index voxels_per_task = 1 << 16;  // voxels per task

// Count, sum and squares of the values of two regions, about a value near them.
struct Sums {
  std::array<double, 2> count{0, 0}, sum{0, 0}, squares{0, 0};

  void add(std::size_t k, double n, double s, double s2) {
    count[k] += n;
    sum[k] += s;
    squares[k] += s2;
  }
};

class LargeSearch {
 public:
  LargeSearch(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask,
              const ContourWeight& weight)
      : values_(values), grid_(grid), mask_(mask), weight_(weight) {}

  // False in much noise.
  bool run(std::vector<std::uint8_t>& labels, std::vector<double>& energy, int& rounds, bool& converged) {
    labels.resize(values_.size());
    if (!start(labels)) return false;
    while (rounds < most_turns && !converged) {
      label(labels);
      ++rounds;
      converged = update(labels, &energy);
    }
    return true;
  }

  [[nodiscard]] double contrast() const { return std::abs(means_[1] - means_[0]); }
  [[nodiscard]] double deviation() const { return std::sqrt(variance_); }
  // Half the squared contrast over the variance is what a voxel at a mean would cost in the other region.
  [[nodiscard]] double mean_force() const { return 0.5 * contrast() * contrast() / variance_; }

 private:
  [[nodiscard]] double middle() const { return 0.5 * (means_[0] + means_[1]); }
  [[nodiscard]] bool inside(std::size_t i) const { return mask_.empty() || mask_[i] != 0; }

  // Classes of the means of small blocks, which have less noise than voxels.
  bool start(std::vector<std::uint8_t>& labels) {
    const std::array<Index, 3> block = block_size(grid_, small_blocks);
    const Index nx = grid_.size[0];
    const std::vector<float> means = block_means(grid_, block, [&](Index row, std::span<float> to) {
      for (Index x = 0; x < nx; ++x) {
        const auto i = static_cast<std::size_t>(row * nx + x);
        to[static_cast<std::size_t>(x)] = inside(i) ? values_[i] : std::numeric_limits<float>::quiet_NaN();
      }
    });
    IntensityBins bins{1e300, -1e300, 256};
    for (const float v : means)
      if (!std::isnan(v)) {
        bins.lo = std::min(bins.lo, static_cast<double>(v));
        bins.hi = std::max(bins.hi, static_cast<double>(v));
      }
    if (!(bins.hi > bins.lo)) return false;
    Histogram histogram(bins);
    for (const float v : means)
      if (!std::isnan(v)) histogram.add(static_cast<double>(v));
    const IntensityClasses classes = optimal_classes(histogram, 2);
    means_ = {classes.means[0], classes.means[1]};
    const auto threshold = static_cast<float>(middle());
    parallel_for(std::ssize(values_), voxels_per_task, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) labels[i] = values_[i] > threshold ? 1 : 0;
    });
    update(labels, nullptr);
    return deviation() <= most_noise * contrast();
  }

  // Each voxel takes the side of its value, in doubt that of the mean of its neighbours.
  void label(std::vector<std::uint8_t>& labels) const {
    double saved = 0;  // at most, by the contour of one voxel
    for (const double along : weight_.along) saved += 2 * weight_.length * along;
    const auto threshold = static_cast<float>(middle());
    const auto doubt = static_cast<float>(saved * variance_ / contrast());
    const Index nx = grid_.size[0];
    parallel_for(std::ssize(values_) / nx, 16, [&](Index begin, Index end) {
      for (Index row = begin; row < end; ++row)
        for (Index x = 0; x < nx; ++x) {
          const Index i = row * nx + x;
          const float off = values_[i] - threshold;
          const bool clear = std::abs(off) > doubt || !inside(static_cast<std::size_t>(i));
          labels[i] = (clear ? off : mean_around(x, row) - threshold) > 0 ? 1 : 0;
        }
    });
  }

  // Mean of the voxel and its neighbours, with the weights of a Gaussian.
  [[nodiscard]] float mean_around(Index x, Index row) const {
    const auto [nx, ny, nz] = grid_.size;
    const Index y = row % ny, z = row / ny;
    float sum = 0, weights = 0;
    for (Index c = std::max<Index>(0, z - 1); c <= std::min(nz - 1, z + 1); ++c)
      for (Index b = std::max<Index>(0, y - 1); b <= std::min(ny - 1, y + 1); ++b) {
        const float side = (c == z ? 1.0F : side_weight) * (b == y ? 1.0F : side_weight);
        for (Index a = std::max<Index>(0, x - 1); a <= std::min(nx - 1, x + 1); ++a) {
          const Index i = (c * ny + b) * nx + a;
          if (!inside(static_cast<std::size_t>(i))) continue;
          const float weight = a == x ? side : side * side_weight;
          sum += weight * values_[i];
          weights += weight;
        }
      }
    return sum / weights;
  }

  // Of the voxels from begin to end. Short runs are summed in single precision, in lanes.
  [[nodiscard]] Sums sums_of(const std::vector<std::uint8_t>& labels, Index begin, Index end, float about) const {
    constexpr Index lanes = 16, run = 32 * lanes;
    Sums sums;
    for (Index first = begin; first < end; first += run) {
      std::array<std::array<float, lanes>, 6> part{};  // count, sum and squares of all; of label 1
      const auto add = [&](Index i, Index lane) {
        const float counts = inside(static_cast<std::size_t>(i)) ? 1.0F : 0.0F;
        const float one = labels[i] != 0 ? counts : 0.0F, off = values_[i] - about;
        part[0][lane] += counts;
        part[1][lane] += counts * off;
        part[2][lane] += counts * off * off;
        part[3][lane] += one;
        part[4][lane] += one * off;
        part[5][lane] += one * off * off;
      };
      const Index stop = std::min(end, first + run);
      Index i = first;
      for (; i + lanes <= stop; i += lanes)
        for (Index lane = 0; lane < lanes; ++lane) add(i + lane, lane);
      for (; i < stop; ++i) add(i, 0);
      std::array<double, 6> total{};
      for (std::size_t k = 0; k < part.size(); ++k)
        for (const float each : part[k]) total[k] += static_cast<double>(each);
      sums.add(0, total[0] - total[3], total[1] - total[4], total[2] - total[5]);
      sums.add(1, total[3], total[4], total[5]);
    }
    return sums;
  }

  // Means and deviation of the regions; true when they hardly change.
  bool update(const std::vector<std::uint8_t>& labels, std::vector<double>* energy) {
    const auto about = static_cast<float>(middle());
    std::vector<Sums> parts(static_cast<std::size_t>((std::ssize(labels) + voxels_per_task - 1) / voxels_per_task));
    parallel_for(std::ssize(labels), voxels_per_task, [&](Index begin, Index end) {
      parts[static_cast<std::size_t>(begin / voxels_per_task)] = sums_of(labels, begin, end, about);
    });
    Sums all;
    for (const Sums& part : parts)
      for (std::size_t k = 0; k < 2; ++k) all.add(k, part.count[k], part.sum[k], part.squares[k]);
    if (all.count[0] == 0 || all.count[1] == 0) return true;
    double within = 0, moved = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      const double mean = static_cast<double>(about) + all.sum[k] / all.count[k];
      within += all.squares[k] - all.sum[k] * all.sum[k] / all.count[k];
      moved = std::max(moved, std::abs(mean - means_[k]));
      means_[k] = mean;
    }
    const double count = all.count[0] + all.count[1], least = contrast() / 512;
    variance_ = std::max(within / count, least * least);
    if (energy == nullptr) return false;
    energy->push_back(0.5 * std::log(variance_) + contour_price(labels, 1, grid_.size, weight_) / count);
    return moved <= means_at_rest * contrast();
  }

  std::span<const float> values_;
  const Grid& grid_;
  std::span<const std::uint8_t> mask_;
  ContourWeight weight_;
  std::array<double, 2> means_{0, 1};
  double variance_ = 0;
};

}  // namespace

template <int Dim>
std::optional<LargePartition<Dim>> find_large_partition(std::span<const float> values, const Grid& grid,
                                                        std::span<const std::uint8_t> mask, const ContourWeight& weight,
                                                        double support, const std::string& kernel,
                                                        const Progress& progress) {
  report(progress, "evolve", 0);
  LargeSearch search(values, grid, mask, weight);
  std::vector<std::uint8_t> labels;
  std::vector<double> energy;
  int rounds = 0;
  bool converged = false;
  if (!search.run(labels, energy, rounds, converged)) return std::nullopt;
  report(progress, "evolve", 0.6);
  const std::array<Index, 3> block = block_size(grid, most_blocks);
  const Grid blocks = block_grid(grid, block);
  // As ContourEnergy::force: -2 inside, 2 outside, whose target is the share of the inside in a block.
  const std::vector<float> force = block_means(grid, block, [&](Index row, std::span<float> to) {
    const std::uint8_t* at = labels.data() + row * grid.size[0];
    for (std::size_t x = 0; x < to.size(); ++x) to[x] = at[x] != 0 ? -2.0F : 2.0F;
  });
  LargePartition<Dim> result{{}, blocks, Lattice<Dim>(blocks.size, blocks.spacing, {1, support, kernel}), {}, {}};
  result.coefficients.assign(static_cast<std::size_t>(result.lattice.array_size()), 0.0F);
  fit_target(result.lattice, ContourEnergy{force.data()}, fit_steps, result.coefficients);
  result.labels = std::move(labels);
  result.energy = std::move(energy);
  result.iterations = rounds;
  result.converged = converged;
  result.smoothness = weight.length / search.mean_force();
  result.noise = search.deviation() / search.contrast();
  const double shortest = grid.spacing.template head<Dim>().minCoeff();
  result.spacing = blocks.spacing.template head<Dim>().minCoeff() / shortest;
  report(progress, "evolve", 1);
  return result;
}

#define CSRBF_INSTANTIATE(Dim)                                                                          \
  template std::optional<LargePartition<Dim>> find_large_partition<Dim>(                                \
      std::span<const float>, const Grid&, std::span<const std::uint8_t>, const ContourWeight&, double, \
      const std::string&, const Progress&);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
