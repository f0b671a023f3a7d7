#include "csrbf/levelset/partition/large_partition.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/levelset/contour/contour_energy.hpp"
#include "csrbf/levelset/image/block_means.hpp"
#include "csrbf/levelset/regions/intensity_classes.hpp"
#include "csrbf/levelset/regions/region_labels.hpp"

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
constexpr Index voxels_per_task = 1 << 16;

// Count, sum and squares of the values of two regions, about a value near them.
struct Sums {
  std::array<double, 2> count{0, 0}, sum{0, 0}, squares{0, 0};

  void add(const Sums& more) {
    for (std::size_t k = 0; k < 2; ++k) {
      count[k] += more.count[k];
      sum[k] += more.sum[k];
      squares[k] += more.squares[k];
    }
  }
};

// What voxels are compared with.
struct TwoMeans {
  std::array<double, 2> means{0, 1};
  double variance = 0;

  [[nodiscard]] double contrast() const { return std::abs(means[1] - means[0]); }
  [[nodiscard]] double deviation() const { return std::sqrt(variance); }
  [[nodiscard]] double middle() const { return 0.5 * (means[0] + means[1]); }
};

// Means and labels in turns, slab by slab: sums depend on how the image is cut, so one in memory is cut in the same
// way.
class LargeSearch {
 public:
  // `labels`: of the whole image, to be filled; empty: they are made again when they are wanted.
  LargeSearch(SliceSource& image, const Grid& grid, std::span<const std::uint8_t> mask,
              const LargePartitionOptions& options, std::span<std::uint8_t> labels)
      : image_(image), grid_(grid), mask_(mask), options_(options), kept_(labels) {}

  // False in much noise.
  bool run() {
    if (!start()) return false;
    while (rounds_ < most_turns && !converged_) {
      labelled_ = now_;
      Sums sums;
      double price = 0;
      border_ = {0, 0};
      for_each_slab([&](Index begin, Index end) {
        const std::span<const std::uint8_t> labels = label(begin, end);
        sums.add(sums_of(labels, begin, end));
        price += contour_price(labels, 1, size_of(end + 1 - begin, begin), options_.weight, end - begin);
        count_border(labels, grid_, mask_, begin, end, border_);
      });
      ++rounds_;
      converged_ = update(sums);
      const double count = sums.count[0] + sums.count[1];
      energy_.push_back(0.5 * std::log(now_.variance) + price / count);
      report(options_.progress, "evolve", 0.1 + 0.1 * rounds_);
    }
    return true;
  }

  // The labels of all slices in turn, again where they were not kept.
  void for_each_label(const LabelsOfSlices& use) {
    for_each_slab([&](Index begin, Index end) {
      use(begin, kept_.empty() ? label(begin, end).first(voxels(end - begin)) : kept(begin, end));
    });
  }

  [[nodiscard]] const TwoMeans& now() const { return now_; }
  // Half the squared contrast over the variance is what a voxel at a mean would cost in the other region.
  [[nodiscard]] double mean_force() const { return 0.5 * now_.contrast() * now_.contrast() / now_.variance; }
  [[nodiscard]] const Sums& sums() const { return sums_; }
  [[nodiscard]] const std::array<Index, 2>& border() const { return border_; }
  [[nodiscard]] std::vector<double>& energy() { return energy_; }
  [[nodiscard]] int rounds() const { return rounds_; }
  [[nodiscard]] bool converged() const { return converged_; }

 private:
  [[nodiscard]] std::size_t voxels(Index slices) const {
    return static_cast<std::size_t>(slices * grid_.size[0] * grid_.size[1]);
  }
  [[nodiscard]] std::span<std::uint8_t> kept(Index begin, Index end) const {
    return kept_.subspan(voxels(begin), voxels(end - begin));
  }
  // The size of some slices of the image, of which there may be fewer.
  [[nodiscard]] std::array<Index, 3> size_of(Index slices, Index begin) const {
    return {grid_.size[0], grid_.size[1], std::min(slices, grid_.size[2] - begin)};
  }
  [[nodiscard]] bool inside(std::size_t i) const { return mask_.empty() || mask_[i] != 0; }

  template <class Use>
  void for_each_slab(const Use& use) const {
    const Index slices = std::max<Index>(1, options_.slab_voxels / (grid_.size[0] * grid_.size[1]));
    for (Index begin = 0; begin < grid_.size[2]; begin += slices) use(begin, std::min(begin + slices, grid_.size[2]));
  }

  // Classes of the means of small blocks, which have less noise than voxels.
  bool start() {
    const Index nx = grid_.size[0];
    BlockMeans blocks(grid_, block_size(grid_, small_blocks));
    for_each_slab([&](Index begin, Index end) {
      const std::span<const float> values = image_.slices(begin, end);
      const auto before = static_cast<Index>(voxels(begin));
      blocks.add(begin, end, [&](Index row, std::span<float> to) {
        for (Index x = 0; x < nx; ++x) {
          const Index i = row * nx + x;
          to[static_cast<std::size_t>(x)] =
              inside(static_cast<std::size_t>(i)) ? values[i - before] : std::numeric_limits<float>::quiet_NaN();
        }
      });
    });
    const std::vector<float> means = blocks.take();
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
    now_.means = {classes.means[0], classes.means[1]};
    const auto threshold = static_cast<float>(now_.middle());
    Sums sums;
    for_each_slab([&](Index begin, Index end) {
      values_ = image_.slices(begin, end);
      first_ = begin;
      std::vector<std::uint8_t>& labels = scratch_;
      labels.resize(values_.size());
      parallel_for(std::ssize(labels), voxels_per_task, [&](Index from, Index to) {
        for (Index i = from; i < to; ++i) labels[i] = values_[i] > threshold ? 1 : 0;
      });
      sums.add(sums_of(labels, begin, end));
    });
    update(sums);
    return now_.deviation() <= most_noise * now_.contrast();
  }

  // The labels of the slices, and of one behind them, if there is one. Each voxel takes the side of its value, in doubt
  // that of the mean of its neighbours.
  std::span<const std::uint8_t> label(Index begin, Index end) {
    const Index last = std::min(end + 1, grid_.size[2]);
    std::span<std::uint8_t> labels;
    if (kept_.empty()) {
      scratch_.resize(voxels(last - begin));
      labels = scratch_;
    } else {
      labels = kept(begin, last);
    }
    first_ = std::max<Index>(0, begin - 1);
    values_ = image_.slices(first_, std::min(last + 1, grid_.size[2]));
    double saved = 0;  // at most, by the contour of one voxel
    for (const double along : options_.weight.along) saved += 2 * options_.weight.length * along;
    const auto threshold = static_cast<float>(labelled_.middle());
    const auto doubt = static_cast<float>(saved * labelled_.variance / labelled_.contrast());
    const Index nx = grid_.size[0], ny = grid_.size[1];
    parallel_for((last - begin) * ny, 16, [&](Index from, Index to) {
      for (Index r = from; r < to; ++r) {
        const Index row = begin * ny + r;
        const float* at = values_.data() + (row - first_ * ny) * nx;
        for (Index x = 0; x < nx; ++x) {
          const float off = at[x] - threshold;
          const bool clear = std::abs(off) > doubt || !inside(static_cast<std::size_t>(row * nx + x));
          labels[static_cast<std::size_t>(r * nx + x)] = (clear ? off : mean_around(x, row) - threshold) > 0 ? 1 : 0;
        }
      }
    });
    return labels;
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
          if (!inside(static_cast<std::size_t>((c * ny + b) * nx + a))) continue;
          const float weight = a == x ? side : side * side_weight;
          sum += weight * values_[((c - first_) * ny + b) * nx + a];
          weights += weight;
        }
      }
    return sum / weights;
  }

  // Of the voxels of some slices, whose labels these are.
  [[nodiscard]] Sums sums_of(std::span<const std::uint8_t> labels, Index begin, Index end) const {
    const auto count = static_cast<Index>(voxels(end - begin));
    std::vector<Sums> parts(static_cast<std::size_t>((count + voxels_per_task - 1) / voxels_per_task));
    parallel_for(count, voxels_per_task, [&](Index from, Index to) {
      parts[static_cast<std::size_t>(from / voxels_per_task)] =
          sums_of_range(labels, static_cast<Index>(voxels(begin)), from, to);
    });
    Sums all;
    for (const Sums& part : parts) all.add(part);
    return all;
  }

  // Of the voxels from begin to end of those behind the first `before` ones. Short runs are summed in single precision,
  // in lanes.
  [[nodiscard]] Sums sums_of_range(std::span<const std::uint8_t> labels, Index before, Index begin, Index end) const {
    constexpr Index lanes = 16, run = 32 * lanes;
    const auto about = static_cast<float>(now_.middle());
    const float* values = values_.data() + (before - static_cast<Index>(voxels(first_)));
    Sums sums;
    for (Index first = begin; first < end; first += run) {
      std::array<std::array<float, lanes>, 6> part{};  // count, sum and squares of all; of label 1
      const auto add = [&](Index i, Index lane) {
        const float counts = inside(static_cast<std::size_t>(before + i)) ? 1.0F : 0.0F;
        const float one = labels[i] != 0 ? counts : 0.0F, off = values[i] - about;
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
      sums.add({{total[0] - total[3], total[3]}, {total[1] - total[4], total[4]}, {total[2] - total[5], total[5]}});
    }
    return sums;
  }

  // Means and deviation of the regions; true when they hardly change.
  bool update(const Sums& sums) {
    const auto about = static_cast<double>(static_cast<float>(now_.middle()));
    TwoMeans next;
    double within = 0, moved = 0;
    sums_ = sums;
    for (std::size_t k = 0; k < 2; ++k) {
      if (sums.count[k] == 0) continue;
      const double off = sums.sum[k] / sums.count[k];
      next.means[k] = about + off;
      moved = std::max(moved, std::abs(next.means[k] - now_.means[k]));
      sums_.sum[k] = sums.count[k] * next.means[k];
      sums_.squares[k] = std::max(0.0, sums.squares[k] - sums.sum[k] * off);
      within += sums.squares[k] - sums.sum[k] * off;
    }
    if (sums.count[0] == 0 || sums.count[1] == 0) return true;
    const double count = sums.count[0] + sums.count[1], least = next.contrast() / 512;
    next.variance = std::max(within / count, least * least);
    now_ = next;
    return moved <= means_at_rest * now_.contrast();
  }

  SliceSource& image_;
  const Grid& grid_;
  std::span<const std::uint8_t> mask_;
  const LargePartitionOptions& options_;
  std::span<std::uint8_t> kept_;
  std::span<const float> values_;  // of the slices from first_ on
  Index first_ = 0;
  std::vector<std::uint8_t> scratch_;
  TwoMeans now_, labelled_;  // and those of the labels
  Sums sums_;                // of the labels: counts and sums of values, squares about the means
  std::array<Index, 2> border_{0, 0};
  std::vector<double> energy_;
  int rounds_ = 0;
  bool converged_ = false;
};

}  // namespace

template <int Dim>
std::optional<LargePartition<Dim>> find_large_partition(SliceSource& image, const Grid& grid,
                                                        std::span<const std::uint8_t> mask,
                                                        const LargePartitionOptions& options,
                                                        std::span<std::uint8_t> labels, const LabelsFound& take) {
  report(options.progress, "evolve", 0);
  LargeSearch search(image, grid, mask, options, labels);
  if (!search.run()) return std::nullopt;
  report(options.progress, "evolve", 0.7);
  const std::array<Index, 3> block = block_size(grid, most_blocks);
  const Grid blocks = block_grid(grid, block);
  LargePartition<Dim> result{
      blocks, Lattice<Dim>(blocks.size, blocks.spacing, {1, options.support, options.kernel}), {}, {}};
  result.outside = search.border()[1] > search.border()[0] ? 1 : 0;
  // As ContourEnergy::force: -2 inside, 2 outside, whose target is the share of the inside in a block.
  BlockMeans force(grid, block);
  search.for_each_label([&](Index begin, std::span<const std::uint8_t> some) {
    const Index slices = std::ssize(some) / (grid.size[0] * grid.size[1]);
    force.add(begin, begin + slices, [&](Index row, std::span<float> to) {
      const std::uint8_t* at = some.data() + (row - begin * grid.size[1]) * grid.size[0];
      for (std::size_t x = 0; x < to.size(); ++x) to[x] = at[x] != 0 ? -2.0F : 2.0F;
    });
    if (take) take(begin, some, result.outside == 1);
  });
  const std::vector<float> target = force.take();
  result.coefficients.assign(static_cast<std::size_t>(result.lattice.array_size()), 0.0F);
  fit_target(result.lattice, ContourEnergy{target.data()}, fit_steps, result.coefficients);
  for (std::size_t k = 0; k < 2; ++k) {
    const double count = search.sums().count[k];
    result.voxels[k] = std::llround(count);
    if (count > 0) result.means[k] = search.sums().sum[k] / count;
    if (count > 0) result.deviations[k] = std::sqrt(search.sums().squares[k] / count);
  }
  result.energy = std::move(search.energy());
  result.iterations = search.rounds();
  result.converged = search.converged();
  result.smoothness = options.weight.length / search.mean_force();
  result.noise = search.now().deviation() / search.now().contrast();
  const double shortest = grid.spacing.template head<Dim>().minCoeff();
  result.spacing = blocks.spacing.template head<Dim>().minCoeff() / shortest;
  report(options.progress, "evolve", 1);
  return result;
}

#define CSRBF_INSTANTIATE(Dim)                                                                                         \
  template std::optional<LargePartition<Dim>> find_large_partition<Dim>(                                               \
      SliceSource&, const Grid&, std::span<const std::uint8_t>, const LargePartitionOptions&, std::span<std::uint8_t>, \
      const LabelsFound&);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
