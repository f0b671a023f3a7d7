#include "csrbf/spatial/distance_transform.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"

namespace csrbf {
namespace {

constexpr Index lines_per_tile = 16;  // neighbours in memory: 16 floats are a cache line

// The lower envelope of the parabolas d_j + (h (i - j))^2 over the voxels i of a line.
class Envelope {
 public:
  Envelope(Index n, double h) : h2_(h * h), place_(n), from_(n) {}

  // Replaces the n squared distances d by their envelope.
  void apply(std::vector<double>& d) {
    const auto n = std::ssize(d);
    build(d);
    if (count_ == 0) return;
    low_.assign(d.begin(), d.end());
    std::size_t k = 0;
    for (Index i = 0; i < n; ++i) {
      while (k + 1 < count_ && from_[k + 1] <= static_cast<double>(i)) ++k;
      const auto away = static_cast<double>(i - place_[k]);
      d[i] = low_[place_[k]] + h2_ * away * away;
    }
  }

 private:
  // Finds the parabolas of the envelope: their positions, and from where on each is the lowest.
  void build(const std::vector<double>& d) {
    count_ = 0;
    for (Index j = 0; j < std::ssize(d); ++j) {
      if (std::isinf(d[j])) continue;
      double start = -std::numeric_limits<double>::infinity();
      for (; count_ > 0; --count_) {
        start = crossing(d, place_[count_ - 1], j);
        if (start > from_[count_ - 1]) break;
      }
      if (count_ == 0) start = -std::numeric_limits<double>::infinity();
      place_[count_] = j;
      from_[count_++] = start;
    }
  }

  // Where the parabola at j falls below the one at i < j.
  [[nodiscard]] double crossing(const std::vector<double>& d, Index i, Index j) const {
    const double rise = (d[j] - d[i]) / h2_;
    return 0.5 * (static_cast<double>(i + j) + rise / static_cast<double>(j - i));
  }

  double h2_;
  std::vector<Index> place_;
  std::vector<double> from_, low_;
  std::size_t count_ = 0;
};

// Transforms one axis. Its lines have n voxels, `stride` apart; `stride` lines lie side by side in a sheet, and sheets
// follow one another.
void transform_axis(Index n, Index stride, double h, std::vector<float>& squared) {
  if (n == 1) return;
  const Index tiles = (stride + lines_per_tile - 1) / lines_per_tile;
  const Index sheets = std::ssize(squared) / (n * stride);
  parallel_for(sheets * tiles, 1, [&](Index begin, Index end) {
    Envelope envelope(n, h);
    std::array<std::vector<double>, lines_per_tile> lines;
    for (Index t = begin; t < end; ++t) {
      const Index first = t % tiles * lines_per_tile, width = std::min(lines_per_tile, stride - first);
      float* const corner = squared.data() + t / tiles * n * stride + first;
      for (Index l = 0; l < width; ++l) lines[l].resize(n);
      for (Index i = 0; i < n; ++i)
        for (Index l = 0; l < width; ++l) lines[l][i] = static_cast<double>(corner[i * stride + l]);
      for (Index l = 0; l < width; ++l) envelope.apply(lines[l]);
      for (Index i = 0; i < n; ++i)
        for (Index l = 0; l < width; ++l) corner[i * stride + l] = static_cast<float>(lines[l][i]);
    }
  });
}

}  // namespace

std::vector<float> distance_transform(const std::array<Index, 3>& size, const Point<3>& spacing,
                                      const std::vector<std::uint8_t>& marked) {
  const Index voxels = size[0] * size[1] * size[2];
  require(std::ssize(marked) == voxels && voxels > 0, "distance_transform", "entries of marked", marked.size(),
          "there must be one for each voxel, and at least one");
  require(spacing.allFinite() && spacing.minCoeff() > 0, "distance_transform", "spacing", spacing.transpose(),
          "must be positive and finite");
  std::vector<float> distance(marked.size());
  for (std::size_t i = 0; i < marked.size(); ++i)
    distance[i] = marked[i] != 0 ? 0.0F : std::numeric_limits<float>::infinity();
  Index stride = 1;
  for (Index a = 0; a < 3; ++a) {
    transform_axis(size[a], stride, spacing[a], distance);
    stride *= size[a];
  }
  for (float& d : distance) d = std::sqrt(d);
  return distance;
}

}  // namespace csrbf
