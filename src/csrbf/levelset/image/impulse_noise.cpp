#include "csrbf/levelset/image/impulse_noise.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

constexpr double near_part = 0.02;                // of the range: values that tails of noise have, too
constexpr double clearly = 3;                     // times as many impulses as such values; by hand
constexpr double least_share = 0.001;             // of all voxels, of both kinds; by hand
constexpr double most_share = 0.2;                // more are a pattern
constexpr double fewest = 2, fewest_of_both = 8;  // voxels; by hand: less is chance
constexpr double alike = 0.25;                    // the rarer kind, of the other, where both could be seen; by hand
constexpr double expected_share = 0.5;            // of the single voxels that places at random would leave; by hand

class Impulses {
 public:
  Impulses(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask)
      : values_(values), grid_(grid), mask_(mask) {
    for (Index i = 0; i < grid.voxels(); ++i) {
      if (!inside(i)) continue;
      lo_ = std::min(lo_, values[i]);
      hi_ = std::max(hi_, values[i]);
    }
  }

  [[nodiscard]] bool exist() {
    if (lo_ >= hi_) return false;
    reach_ = static_cast<float>(near_part) * (hi_ - lo_);
    low_ = count(lo_);
    high_ = count(hi_);
    const double singles = low_.singles + high_.singles;
    return low_.stand_out && high_.stand_out && std::min(low_.singles, high_.singles) >= fewest &&
           singles >= std::max(fewest_of_both, least_share * static_cast<double>(grid_.voxels())) &&
           std::min(low_.rate, high_.rate) >= alike * std::max(low_.rate, high_.rate);
  }

  [[nodiscard]] std::vector<float> without() const {
    std::vector<float> result(values_.begin(), values_.end());
    parallel_for(grid_.voxels(), 1 << 14, [&](Index begin, Index end) {
      std::vector<float> around;
      for (Index i = begin; i < end; ++i) {
        if (!inside(i) || !is_impulse(i)) continue;
        gather(i, around);
        if (!around.empty()) result[i] = median(around);
      }
    });
    return result;
  }

 private:
  [[nodiscard]] bool inside(Index i) const { return mask_.empty() || mask_[i] != 0; }

  // Voxels of the least or the greatest value.
  struct Kind {
    double singles = 0;        // those none of whose neighbours is near that value
    double rate = 0;           // their share of all places with such neighbours
    bool stand_out = false;    // single ones are no pattern, and of single values close by there are few
    bool are_regions = false;  // fewer are single than places at random would leave
  };

  [[nodiscard]] Kind count(float value) const {
    double places = 0, singles = 0, others = 0, equal = 0;
    for (Index i = 0; i < grid_.voxels(); ++i) {
      if (!inside(i)) continue;
      if (values_[i] == value) equal += 1;
      if (!is_alone(i, value)) continue;
      places += 1;
      if (values_[i] == value)
        singles += 1;
      else if (is_near(i, value))
        others += 1;
    }
    const auto all = static_cast<double>(grid_.voxels());
    const double expected = equal * std::pow(1 - equal / all, 2 * grid_.dimension());
    return {singles, singles / std::max(1.0, places), singles < most_share * all && singles > clearly * others,
            singles < expected_share * expected};
  }

  [[nodiscard]] bool is_impulse(Index i) const {
    if (values_[i] != lo_ && values_[i] != hi_) return false;
    return !(values_[i] == lo_ ? low_ : high_).are_regions || is_alone(i, values_[i]);
  }

  [[nodiscard]] bool is_near(Index i, float value) const { return std::abs(values_[i] - value) <= reach_; }

  // Whether no neighbour is near that value.
  [[nodiscard]] bool is_alone(Index i, float value) const {
    Index stride = 1;
    for (int a = 0; a < 3; ++a) {
      const Index at = i / stride % grid_.size[a];
      if (at > 0 && is_near(i - stride, value)) return false;
      if (at + 1 < grid_.size[a] && is_near(i + stride, value)) return false;
      stride *= grid_.size[a];
    }
    return true;
  }

  void gather(Index i, std::vector<float>& around) const {
    const auto [nx, ny, nz] = grid_.size;
    const Index x = i % nx, y = i / nx % ny, z = i / (nx * ny);
    around.clear();
    for (Index c = std::max<Index>(0, z - 1); c <= std::min(nz - 1, z + 1); ++c)
      for (Index b = std::max<Index>(0, y - 1); b <= std::min(ny - 1, y + 1); ++b)
        for (Index a = std::max<Index>(0, x - 1); a <= std::min(nx - 1, x + 1); ++a) {
          const Index j = (c * ny + b) * nx + a;
          if (j != i && inside(j)) around.push_back(values_[j]);
        }
  }

  std::span<const float> values_;
  const Grid& grid_;
  std::span<const std::uint8_t> mask_;
  float lo_ = std::numeric_limits<float>::max(), hi_ = std::numeric_limits<float>::lowest(), reach_ = 0;
  Kind low_, high_;
};

}  // namespace

std::optional<double> repair_impulses(std::span<const float> values, const Grid& grid,
                                      std::span<const std::uint8_t> mask, std::vector<float>& repaired) {
  Impulses impulses(values, grid, mask);
  if (!impulses.exist()) return std::nullopt;
  std::vector<float> result = impulses.without();
  const auto [lo, hi] = std::minmax_element(result.begin(), result.end());
  if (*lo == *hi) return std::nullopt;
  double changed = 0, all = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    changed += result[i] != values[i] ? 1 : 0;
    all += mask.empty() || mask[i] != 0 ? 1 : 0;
  }
  repaired = std::move(result);
  return changed / all;
}

}  // namespace csrbf
