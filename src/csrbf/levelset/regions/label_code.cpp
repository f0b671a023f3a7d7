#include "csrbf/levelset/regions/label_code.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

namespace csrbf {
namespace {

constexpr std::size_t contexts = 128;  // of seven neighbours
constexpr std::uint64_t ones = 0x0101010101010101U;
constexpr Index margin = 2;  // zeros before and behind a row, which neighbours may lie in

// A row with zeros around it; all zeros where there is none.
class Row {
 public:
  explicit Row(Index size) : values_(static_cast<std::size_t>(size + 2 * margin), 0) {}

  void read(std::span<const std::uint8_t> labels, Index row, bool exists) {
    const std::size_t size = values_.size() - 2 * margin;
    if (!exists) {
      std::fill(values_.begin(), values_.end(), std::uint8_t{0});
      return;
    }
    const std::uint8_t* from = labels.data() + static_cast<std::size_t>(row) * size;
    for (std::size_t i = 0; i < size; ++i) values_[i + margin] = from[i] != 0 ? 1 : 0;
  }
  [[nodiscard]] const std::uint8_t* begin() const { return values_.data() + margin; }

 private:
  std::vector<std::uint8_t> values_;
};

std::uint64_t eight(const std::uint8_t* labels) {
  std::uint64_t result = 0;
  std::memcpy(&result, labels, sizeof(result));
  return result;
}

// Of a sequence with so many zeros and ones, where a one is as likely as those before it say.
double sequence_code(double zeros, double ones) {
  return std::lgamma(zeros + ones + 1) - std::lgamma(zeros + 0.5) - std::lgamma(ones + 0.5) + 2 * std::lgamma(0.5);
}

}  // namespace

double label_code(std::span<const std::uint8_t> labels, const Grid& grid, std::span<const std::uint8_t> mask) {
  const Index nx = grid.size[0], ny = grid.size[1], rows = ny * grid.size[2];
  const bool deep = grid.size[2] > 1;
  std::array<std::array<double, 2>, contexts> counts{};
  Row here_row(nx), above_row(nx), third_row(nx), fourth_row(nx);
  for (Index row = 0; row < rows; ++row) {
    const Index y = row % ny;
    here_row.read(labels, row, true);
    above_row.read(labels, row - 1, y > 0);
    // In space two rows of the slice before, in the plane the one two rows before.
    third_row.read(labels, deep ? row - ny : row - 2, deep ? row >= ny : y > 1);
    fourth_row.read(labels, row - ny + 1, deep && row >= ny && y + 1 < ny);
    const std::uint8_t *here = here_row.begin(), *above = above_row.begin(), *third = third_row.begin(),
                       *fourth = fourth_row.begin();
    for (Index x = 0; x < nx; ++x) {
      // Most voxels are as all around them.
      if (mask.empty() && x + 8 <= nx) {
        const std::uint64_t others = deep ? eight(third + x + 1) : eight(here + x - 2);
        const std::uint64_t fourths = deep ? eight(fourth + x) : others;
        const std::uint64_t any = eight(here + x - 1) | eight(here + x) | eight(above + x - 1) | eight(above + x + 2) |
                                  eight(third + x) | others | fourths;
        const std::uint64_t all = eight(here + x - 1) & eight(here + x) & eight(above + x - 1) & eight(above + x + 2) &
                                  eight(third + x) & others & fourths;
        if (any == 0 || all == ones) {
          counts[any == 0 ? 0 : contexts - 1][any == 0 ? 0 : 1] += 8;
          x += 7;
          continue;
        }
      }
      if (!mask.empty() && mask[static_cast<std::size_t>(row * nx + x)] == 0) continue;
      const unsigned common = here[x - 1] | above[x - 1] << 1U | above[x] << 2U | above[x + 1] << 3U | third[x] << 4U;
      const unsigned others = deep ? third[x + 1] << 5U | fourth[x] << 6U : here[x - 2] << 5U | above[x + 2] << 6U;
      counts[common | others][here[x]] += 1;
    }
  }
  double nats = 0;
  for (const auto& [zeros, ones] : counts)
    if (zeros + ones > 0) nats += sequence_code(zeros, ones);
  return nats;
}

}  // namespace csrbf
