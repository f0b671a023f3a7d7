#include "csrbf/levelset/disturbances/drawn_over.hpp"

#include "csrbf/levelset/frame/image_frame.hpp"
#include "csrbf/levelset/regions/label_runs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace csrbf {
namespace {

constexpr double fewest = 12, most_share = 0.05;  // voxels, and of all; by hand
constexpr int pen = 4;                            // half the width of a stroke in voxels, at most; by hand
constexpr double thick_share = 0.3;               // of the voxels, that may be within wider ones; by hand
constexpr double joined_share = 0.5;              // of the voxels, that touch two others at least; by hand: no impulses
constexpr double uneven_share = 0.03;             // of the voxels, that others between them are close to; by hand
constexpr double sharp = 0.1;                     // of the step of an edge, that is left two voxels away; by hand
constexpr double stands_out = 0.2;                // of the range, that strokes differ from what is beside them; by hand

class Strokes {
 public:
  Strokes(const Volume<float>& image, std::span<const std::uint8_t> mask)
      : image_(image),
        mask_(mask),
        components_(static_cast<std::size_t>(image.components)),
        nx_(image.grid.size[0]),
        ny_(image.grid.size[1]) {}

  std::optional<DrawnOver> find() {
    std::optional<DrawnOver> found;
    double most = 0;
    for (const auto& [value, all] : extremes()) {
      if (all < fewest || all > most_share * static_cast<double>(voxels())) continue;
      std::vector<std::uint8_t> marked(voxels());
      for (std::size_t i = 0; i < marked.size(); ++i) marked[i] = has(i, value) ? 1 : 0;
      const double count = keep_groups(marked);
      if (count < fewest || count <= most || !are_strokes(marked, count) || !are_even(marked, count, value) ||
          !have_sharp_edges(marked, value))
        continue;
      most = count;
      found = DrawnOver{grown(marked, 1), value[0]};
    }
    return found;
  }

 private:
  [[nodiscard]] std::size_t voxels() const { return static_cast<std::size_t>(nx_ * ny_); }
  [[nodiscard]] bool inside(std::size_t i) const { return mask_.empty() || mask_[i] != 0; }
  [[nodiscard]] std::span<const float> at(std::size_t i) const {
    return std::span(image_.values).subspan(i * components_, components_);
  }
  [[nodiscard]] bool has(std::size_t i, const std::vector<float>& value) const {
    return inside(i) && std::equal(value.begin(), value.end(), at(i).begin());
  }

  // Values of which each component is the least or the greatest there is, and how many voxels have them.
  std::map<std::vector<float>, double> extremes() {
    constexpr float infinite = std::numeric_limits<float>::infinity();
    std::vector<float> least(components_, infinite), greatest(components_, -infinite);
    for (std::size_t i = 0; i < voxels(); ++i)
      for (std::size_t c = 0; c < components_ && inside(i); ++c) {
        if (std::isnan(at(i)[c])) continue;
        least[c] = std::min(least[c], at(i)[c]);
        greatest[c] = std::max(greatest[c], at(i)[c]);
      }
    std::map<std::vector<float>, double> counts;
    for (std::size_t i = 0; i < voxels(); ++i) {
      bool extreme = inside(i);
      for (std::size_t c = 0; c < components_ && extreme; ++c)
        extreme = at(i)[c] == least[c] || at(i)[c] == greatest[c];
      if (extreme) counts[{at(i).begin(), at(i).end()}] += 1;
    }
    for (std::size_t c = 0; c < components_; ++c)
      range_ = std::max(range_, static_cast<double>(greatest[c] - least[c]));
    return counts;
  }

  // Of squares around the marked voxels.
  [[nodiscard]] std::vector<std::uint8_t> grown(const std::vector<std::uint8_t>& marked, Index by) const {
    std::vector<std::uint8_t> result(marked.size(), 0), along(marked.size(), 0);
    for (Index y = 0; y < ny_; ++y)
      for (Index x = 0; x < nx_; ++x)
        if (marked[y * nx_ + x] != 0)
          for (Index i = std::max<Index>(0, x - by); i <= std::min(nx_ - 1, x + by); ++i) along[y * nx_ + i] = 1;
    for (Index y = 0; y < ny_; ++y)
      for (Index j = std::max<Index>(0, y - by); j <= std::min(ny_ - 1, y + by); ++j)
        for (Index x = 0; x < nx_; ++x) result[j * nx_ + x] |= along[y * nx_ + x];
    return result;
  }

  // Leaves out what is not beside others of its kind, as letters are; returns how many are left.
  [[nodiscard]] double keep_groups(std::vector<std::uint8_t>& marked) const {
    const std::vector<std::uint8_t> joined = grown(marked, pen);
    LabelRuns runs(joined, image_.grid);
    const LabelRuns::Parts parts = runs.parts(1);
    std::vector<Index> counts(parts.count, 0);
    const auto for_all = [&](const auto& use) {
      for (Index row = 0; row < ny_; ++row)
        for (std::size_t r = runs.first[row]; r < runs.first[row + 1]; ++r)
          for (Index x = runs.runs[r].begin; parts.of_run[r] >= 0 && x < runs.runs[r].end; ++x)
            if (marked[row * nx_ + x] != 0) use(row * nx_ + x, counts[parts.of_run[r]]);
    };
    for_all([](Index, Index& count) { ++count; });
    double left = 0;
    for_all([&](Index i, Index count) {
      marked[i] = static_cast<double>(count) >= fewest ? 1 : 0;
      left += marked[i];
    });
    return left;
  }

  // Lines of a pen, and no single voxels.
  [[nodiscard]] bool are_strokes(const std::vector<std::uint8_t>& marked, double count) const {
    std::vector<std::uint8_t> others(marked.size());
    for (std::size_t i = 0; i < others.size(); ++i) others[i] = marked[i] == 0 ? 1 : 0;
    const std::vector<std::uint8_t> near = grown(others, pen);
    double thick = 0, joined = 0;
    for (Index y = 0; y < ny_; ++y)
      for (Index x = 0; x < nx_; ++x) {
        if (marked[y * nx_ + x] == 0) continue;
        thick += near[y * nx_ + x] == 0 ? 1 : 0;
        int beside = 0;
        for (Index j = std::max<Index>(0, y - 1); j <= std::min(ny_ - 1, y + 1); ++j)
          for (Index i = std::max<Index>(0, x - 1); i <= std::min(nx_ - 1, x + 1); ++i) beside += marked[j * nx_ + i];
        joined += beside > 2 ? 1 : 0;
      }
    return thick <= thick_share * count && joined >= joined_share * count;
  }

  // What noise and a camera saturate has nearly the same value in between.
  [[nodiscard]] bool are_even(const std::vector<std::uint8_t>& marked, double count,
                              const std::vector<float>& value) const {
    double uneven = 0;
    for (Index y = 0; y < ny_; ++y)
      for (Index x = 0; x < nx_; ++x) {
        const Index i = y * nx_ + x;
        if (marked[i] != 0 || !inside(i)) continue;
        const bool between = (x > 0 && x + 1 < nx_ && marked[i - 1] != 0 && marked[i + 1] != 0) ||
                             (y > 0 && y + 1 < ny_ && marked[i - nx_] != 0 && marked[i + nx_] != 0);
        if (!between) continue;
        double most = 0;
        for (std::size_t c = 0; c < components_; ++c)
          most = std::max(most, static_cast<double>(std::abs(at(i)[c] - value[c])));
        uneven += most < stands_out * range_ ? 1 : 0;
      }
    return uneven <= uneven_share * count;
  }

  [[nodiscard]] bool have_sharp_edges(const std::vector<std::uint8_t>& marked, const std::vector<float>& value) const {
    const std::vector<std::uint8_t> one = grown(marked, 1), two = grown(marked, 2), three = grown(marked, 3),
                                    far = grown(marked, 5);
    double most = 0;
    bool blurred = false;
    for (std::size_t c = 0; c < components_; ++c) {
      std::array<double, 2> sums{0, 0}, counts{0, 0};
      for (std::size_t i = 0; i < voxels(); ++i) {
        const bool next = two[i] != 0 && one[i] == 0, beyond = far[i] != 0 && three[i] == 0;
        if (!inside(i) || std::isnan(at(i)[c]) || (!next && !beyond)) continue;
        sums[beyond ? 1 : 0] += static_cast<double>(at(i)[c]);
        counts[beyond ? 1 : 0] += 1;
      }
      if (counts[0] == 0 || counts[1] == 0) return false;
      const double next = sums[0] / counts[0], beyond = sums[1] / counts[1];
      const double step = static_cast<double>(value[c]) - beyond;
      most = std::max(most, std::abs(step));
      blurred = blurred || (std::abs(step) > stands_out * range_ && (next - beyond) / step > sharp);
    }
    return !blurred && most > stands_out * range_;
  }

  const Volume<float>& image_;
  std::span<const std::uint8_t> mask_;
  std::size_t components_;
  Index nx_, ny_;
  double range_ = 0;  // of the values
};

}  // namespace

std::optional<DrawnOver> find_drawn_over(const Volume<float>& image, std::span<const std::uint8_t> mask) {
  if (image.grid.dimension() != 2 || is_drawing(image.values)) return std::nullopt;
  return Strokes(image, mask).find();
}

}  // namespace csrbf
