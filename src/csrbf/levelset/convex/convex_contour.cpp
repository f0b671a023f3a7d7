#include "csrbf/levelset/convex/convex_contour.hpp"

#include "csrbf/core/parallel_sum.hpp"
#include "csrbf/core/simd.hpp"

#include <limits>

namespace csrbf {
namespace {

constexpr Index width = 16;           // voxels of a tile, along x: one register of AVX-512
constexpr int most_iterations = 300;  // by hand: enough for contours without noise, a voxel or two for the noisiest
constexpr int check_every = 5;        // iterations between two looks at the change
constexpr Index tiles_per_task = 512;

struct Tile {
  std::array<Index, 3> next{-1, -1, -1}, last{-1, -1, -1};  // tiles along x, y, z; -1: none
};

struct Steps {
  float dual, primal, bound;
  std::array<float, 3> along;
};

struct Arrays {
  std::vector<float> u, extrapolated, force, px, py, pz;
};

// One ascent of the dual variables of tiles [begin, end). Tiles without a neighbour have difference 0 there.
template <bool Flat>
CSRBF_ALWAYS_INLINE void ascend_in(const Tile* tiles, const Index* counts, Index begin, Index end, const Steps& by,
                                   const float* u, float* px, float* py, float* pz) {
  for (Index t = begin; t < end; ++t) {
    const Tile& tile = tiles[t];
    const float* here = u + t * width;
    const float* up = u + (tile.next[1] >= 0 ? tile.next[1] : t) * width;
    const float* above = u + (tile.next[2] >= 0 ? tile.next[2] : t) * width;
    float right[width];
    for (Index i = 0; i + 1 < width; ++i) right[i] = here[i + 1];
    right[width - 1] = here[width - 1];
    if (tile.next[0] >= 0)
      right[width - 1] = u[tile.next[0] * width];
    else
      right[counts[t] - 1] = here[counts[t] - 1];
    float* x = px + t * width;
    float* y = py + t * width;
    float* z = Flat ? nullptr : pz + t * width;
    for (Index i = 0; i < width; ++i) {
      const float a = x[i] + by.dual * by.along[0] * (right[i] - here[i]);
      const float b = y[i] + by.dual * by.along[1] * (up[i] - here[i]);
      float squares = a * a + b * b, c = 0;
      if constexpr (!Flat) {
        c = z[i] + by.dual * by.along[2] * (above[i] - here[i]);
        squares += c * c;
      }
      const float scale = by.bound / std::max(by.bound, std::sqrt(squares));
      x[i] = a * scale;
      y[i] = b * scale;
      if constexpr (!Flat) z[i] = c * scale;
    }
  }
}

CSRBF_ALWAYS_INLINE void ascend(const Tile* tiles, const Index* counts, Index begin, Index end, const Steps& by,
                                const float* u, float* px, float* py, float* pz) {
  if (pz == nullptr)
    ascend_in<true>(tiles, counts, begin, end, by, u, px, py, pz);
  else
    ascend_in<false>(tiles, counts, begin, end, by, u, px, py, pz);
}

// One descent of u; returns the sum of its changes.
template <bool Flat>
CSRBF_ALWAYS_INLINE double descend_in(const Tile* tiles, Index begin, Index end, const Steps& by, const float* force,
                                      const float* px, const float* py, const float* pz, float* u,
                                      float* extrapolated) {
  static constexpr float none[width] = {};
  double sum = 0;
  for (Index t = begin; t < end; ++t) {
    const Tile& tile = tiles[t];
    const float* x = px + t * width;
    const float* y = py + t * width;
    const float* z = Flat ? none : pz + t * width;
    const float* down = tile.last[1] >= 0 ? py + tile.last[1] * width : none;
    const float* below = !Flat && tile.last[2] >= 0 ? pz + tile.last[2] * width : none;
    float left[width];
    left[0] = tile.last[0] >= 0 ? px[tile.last[0] * width + width - 1] : 0.0F;
    for (Index i = 1; i < width; ++i) left[i] = x[i - 1];
    float* here = u + t * width;
    float* ahead = extrapolated + t * width;
    const float* F = force + t * width;
    float change[width];
    for (Index i = 0; i < width; ++i) {
      float divergence = by.along[0] * (x[i] - left[i]) + by.along[1] * (y[i] - down[i]);
      if constexpr (!Flat) divergence += by.along[2] * (z[i] - below[i]);
      const float moved = here[i] + by.primal * (divergence - F[i]);
      const float now = std::min(1.0F, std::max(0.0F, moved));
      change[i] = std::abs(now - here[i]);
      ahead[i] = 2 * now - here[i];
      here[i] = now;
    }
    for (Index i = 0; i < width; ++i) sum += static_cast<double>(change[i]);
  }
  return sum;
}

CSRBF_ALWAYS_INLINE double descend(const Tile* tiles, Index begin, Index end, const Steps& by, const float* force,
                                   const float* px, const float* py, const float* pz, float* u, float* extrapolated) {
  if (pz == nullptr) return descend_in<true>(tiles, begin, end, by, force, px, py, pz, u, extrapolated);
  return descend_in<false>(tiles, begin, end, by, force, px, py, pz, u, extrapolated);
}

// The tiles that hold voxels in doubt, and those whose differences they take part in.
class Doubt {
 public:
  Doubt(const std::array<Index, 3>& size, const ContourWeight& weight, std::span<const float> force,
        std::span<std::uint8_t> labels, ContourState* state)
      : state_(state),
        size_(size),
        columns_((size[0] + width - 1) / width),
        force_(force),
        labels_(labels),
        weight_(weight) {
    // A voxel takes part in one forward and one backward difference along each axis.
    most_ = 0;
    for (const double along : weight.along) most_ += 2 * weight.length * along;
    number_.assign(static_cast<std::size_t>(columns_ * size[1] * size[2]), -1);
    mark();
    gather();
    if (state_ != nullptr) exchange_state(true);
  }

  int solve() {
    if (list_.empty()) return 0;
    double norm = 0;  // of the differences, squared
    for (const double along : weight_.along) norm += 4 * along * along;
    const double root = std::sqrt(norm);
    // u is of the order of 1, the dual variables of that of the length.
    const Steps by{static_cast<float>(weight_.length / root),
                   static_cast<float>(1 / (weight_.length * root)),
                   static_cast<float>(weight_.length),
                   {static_cast<float>(weight_.along[0]), static_cast<float>(weight_.along[1]),
                    static_cast<float>(weight_.along[2])}};
    const auto n = std::ssize(list_);
    const double at_rest = state_ != nullptr ? state_->at_rest : ContourState().at_rest;
    int iteration = 0;
    while (iteration < most_iterations) {
      ++iteration;
      parallel_for(n, tiles_per_task, [&](Index begin, Index end) {
        simd<ascend>(tiles_.data(), counts_.data(), begin, end, by, a_.extrapolated.data(), a_.px.data(), a_.py.data(),
                     pz());
      });
      const double change = parallel_sum(n, tiles_per_task, [&](Index begin, Index end) {
        return simd<descend>(tiles_.data(), begin, end, by, a_.force.data(), a_.px.data(), a_.py.data(), pz(),
                             a_.u.data(), a_.extrapolated.data());
      });
      if (iteration % check_every == 0 && change <= at_rest * static_cast<double>(doubtful_)) break;
    }
    for (Index t = 0; t < n; ++t)
      for (Index i = 0; i < counts_[t]; ++i) labels_[first(list_[t]) + i] = a_.u[t * width + i] > 0.5F ? 1 : 0;
    if (state_ != nullptr) exchange_state(false);
    return iteration;
  }

 private:
  [[nodiscard]] bool is_flat() const { return weight_.along[2] == 0; }
  [[nodiscard]] float* pz() { return is_flat() ? nullptr : a_.pz.data(); }

  // Reads or writes the values of the tiles.
  void exchange_state(bool read) {
    const auto exchange = [&](std::vector<float>& all, std::vector<float>& mine, const auto& take) {
      all.resize(labels_.size(), 0.0F);
      for (std::size_t t = 0; t < list_.size(); ++t) {
        float* here = mine.data() + t * width;
        float* there = all.data() + first(list_[t]);
        for (Index i = 0; i < counts_[t]; ++i)
          if (read)
            take(there[i], here[i]);
          else
            there[i] = here[i];
      }
    };
    exchange(state_->u, a_.u, [](float old, float& u) {
      if ((old > 0.5F) == (u > 0.5F)) u = old;
    });
    a_.extrapolated = a_.u;
    const std::array<std::vector<float>*, 3> duals{&a_.px, &a_.py, &a_.pz};
    for (std::size_t a = 0; a < (is_flat() ? 2 : 3); ++a)
      exchange(state_->duals[a], *duals[a], [](float old, float& p) { p = old; });
  }

  [[nodiscard]] Index first(Index tile) const { return tile / columns_ * size_[0] + tile % columns_ * width; }
  [[nodiscard]] Index count(Index tile) const { return std::min(width, size_[0] - tile % columns_ * width); }

  // The tile a step along an axis away, or -1.
  [[nodiscard]] Index neighbour(Index tile, std::size_t axis, Index step) const {
    const std::array<Index, 3> extent{columns_, size_[1], size_[2]};
    const std::array<Index, 3> stride{1, columns_, columns_ * size_[1]};
    const Index at = tile / stride[axis] % extent[axis] + step;
    return at < 0 || at >= extent[axis] ? -1 : tile + step * stride[axis];
  }

  void mark() {
    const auto n = std::ssize(number_);
    // Sets the labels of voxels without doubt.
    parallel_for(n, tiles_per_task, [&](Index begin, Index end) {
      for (Index tile = begin; tile < end; ++tile)
        for (Index i = first(tile), last = i + count(tile); i < last; ++i)
          if (is_clear(force_[i]))
            labels_[i] = force_[i] < 0 ? 1 : 0;
          else
            number_[tile] = 0;
    });
    std::vector<Index> found;
    for (Index tile = 0; tile < n; ++tile)
      if (number_[tile] == 0) found.push_back(tile);
    const auto add = [&](std::vector<Index>& to, Index tile) {
      if (tile < 0 || number_[tile] == 0) return;
      number_[tile] = 0;
      to.push_back(tile);
    };
    // Differences at a voxel and the ones before it; then the voxels that these reach.
    const std::size_t doubtful = found.size();
    for (std::size_t k = 0; k < doubtful; ++k)
      for (std::size_t a = 0; a < 3; ++a) add(found, neighbour(found[k], a, -1));
    const std::size_t cells = found.size();
    for (std::size_t k = 0; k < cells; ++k)
      for (std::size_t a = 0; a < 3; ++a) add(found, neighbour(found[k], a, 1));
    std::sort(found.begin(), found.end());
    list_ = std::move(found);
    for (Index t = 0; t < std::ssize(list_); ++t) number_[list_[t]] = t;
  }

  void gather() {
    const auto n = list_.size();
    tiles_.resize(n);
    counts_.resize(n);
    for (std::vector<float>* values : {&a_.u, &a_.force, &a_.px, &a_.py}) values->assign(n * width, 0.0F);
    if (!is_flat()) a_.pz = a_.px;
    for (std::size_t t = 0; t < n; ++t) {
      for (std::size_t a = 0; a < 3; ++a) {
        const Index next = neighbour(list_[t], a, 1), last = neighbour(list_[t], a, -1);
        tiles_[t].next[a] = next < 0 ? -1 : number_[next];
        tiles_[t].last[a] = last < 0 ? -1 : number_[last];
      }
      counts_[t] = count(list_[t]);
      const Index from = first(list_[t]);
      for (Index i = 0; i < counts_[t]; ++i) {
        const float F = force_[from + i];
        const std::size_t to = t * width + static_cast<std::size_t>(i);
        a_.u[to] = labels_[from + i] != 0 ? 1.0F : 0.0F;
        a_.force[to] = F;
        doubtful_ += is_clear(F) ? 0 : 1;
      }
    }
    a_.extrapolated = a_.u;
  }

  [[nodiscard]] bool is_clear(float F) const { return std::abs(static_cast<double>(F)) > most_; }

  ContourState* state_;
  std::array<Index, 3> size_;
  Index columns_;
  std::span<const float> force_;
  std::span<std::uint8_t> labels_;
  ContourWeight weight_;
  double most_ = 0;
  std::vector<Index> number_;  // of each tile of the image in `list_`; -1: not in it
  std::vector<Index> list_, counts_;
  std::vector<Tile> tiles_;
  Arrays a_;
  Index doubtful_ = 0;
};

}  // namespace

ContourWeight contour_weight(const Grid& grid, double length) {
  ContourWeight weight{length, {0, 0, 0}};
  double shortest = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
    if (grid.size[a] > 1) shortest = std::min(shortest, grid.spacing[a]);
  for (int a = 0; a < 3; ++a)
    if (grid.size[a] > 1) weight.along[a] = shortest / grid.spacing[a];
  return weight;
}

double contour_price(std::span<const std::uint8_t> labels, std::uint8_t label, const std::array<Index, 3>& size,
                     const ContourWeight& weight) {
  return contour_price(labels, label, size, weight, size[2]);
}

double contour_price(std::span<const std::uint8_t> labels, std::uint8_t label, const std::array<Index, 3>& size,
                     const ContourWeight& weight, Index slices) {
  const Index nx = size[0], nxy = nx * size[1];
  // By which of the differences are not 0.
  std::array<double, 8> norm{};
  for (std::size_t k = 0; k < 8; ++k) {
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a)
      if ((k >> a & 1) != 0) sum += weight.along[a] * weight.along[a];
    norm[k] = weight.length * std::sqrt(sum);
  }
  return parallel_sum(size[1] * slices, 16, [&](Index begin, Index end) {
    double sum = 0;
    for (Index row = begin; row < end; ++row) {
      const bool y = row % size[1] + 1 < size[1], z = row / size[1] + 1 < size[2];
      const std::uint8_t* at = labels.data() + row * nx;
      for (Index x = 0; x < nx; ++x) {
        const bool here = at[x] == label;
        std::size_t k = x + 1 < nx && (at[x + 1] == label) != here ? 1 : 0;
        if (y && (at[x + nx] == label) != here) k |= 2;
        if (z && (at[x + nxy] == label) != here) k |= 4;
        sum += norm[k];
      }
    }
    return sum;
  });
}

int convex_contour(const std::array<Index, 3>& size, const ContourWeight& weight, std::span<const float> force,
                   std::span<std::uint8_t> labels, ContourState* state) {
  return Doubt(size, weight, force, labels, state).solve();
}

}  // namespace csrbf
