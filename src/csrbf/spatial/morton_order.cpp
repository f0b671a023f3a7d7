#include "csrbf/spatial/morton_order.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/radix_sort.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace csrbf {
namespace {

template <int Dim>
constexpr int bits = std::min(32, 63 / Dim);  // per coordinate

// Bytes with Dim - 1 zeros between their bits.
template <int Dim>
constexpr std::array<std::uint64_t, 256> spread_bytes = [] {
  std::array<std::uint64_t, 256> table{};
  for (std::size_t byte = 0; byte < table.size(); ++byte)
    for (int bit = 0; bit < 8; ++bit) table[byte] |= std::uint64_t{byte >> bit & 1U} << (bit * Dim);
  return table;
}();

// Interleaves the bits of all coordinates, those of the first one in the lowest places.
template <int Dim>
std::uint64_t morton_code(const Point<Dim>& unit) {
  constexpr double cells = static_cast<double>(std::uint64_t{1} << bits<Dim>);
  std::uint64_t code = 0;
  for (int axis = 0; axis < Dim; ++axis) {
    const double scaled = unit[axis] * cells;
    const auto cell = scaled > 0 ? static_cast<std::uint64_t>(std::min(scaled, cells - 1)) : 0;  // 0 also for NaN
    for (int byte = 0; 8 * byte < bits<Dim>; ++byte)
      code |= spread_bytes<Dim>[cell >> (8 * byte) & 255U] << (8 * byte * Dim + axis);
  }
  return code;
}

}  // namespace

template <int Dim>
std::vector<Index> morton_order(const PointsRef<Dim>& points) {
  const auto n = static_cast<std::size_t>(points.cols());
  require(n <= std::numeric_limits<std::uint32_t>::max(), "morton_order", "points", n, "must be fewer than 2^32");
  const Box<Dim> box = bounding_box<Dim>(points);
  const double extent = box.extent().maxCoeff();
  constexpr int low_bits = std::max(0, bits<Dim> * Dim - 32);
  std::vector<std::uint64_t> code(n);
  std::vector<Keyed> items(n);
  constexpr Index grain = 8192;
  parallel_for(points.cols(), grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      code[at] = morton_code<Dim>((points.col(i) - box.lo) / extent);
      items[at] = {static_cast<std::uint32_t>(code[at] >> low_bits), static_cast<std::uint32_t>(i)};
    }
  });
  radix_sort(items);
  for (std::size_t begin = 0, end = 0; begin < n; begin = end) {  // the few with equal keys by their whole codes
    for (end = begin + 1; end < n && items[end].key == items[begin].key;) ++end;
    if (end - begin > 1)
      std::sort(items.data() + begin, items.data() + end, [&](const Keyed& a, const Keyed& b) {
        return std::pair(code[a.index], a.index) < std::pair(code[b.index], b.index);
      });
  }
  std::vector<Index> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = items[i].index;
  return order;
}

template std::vector<Index> morton_order<1>(const PointsRef<1>&);
template std::vector<Index> morton_order<2>(const PointsRef<2>&);
template std::vector<Index> morton_order<3>(const PointsRef<3>&);
template std::vector<Index> morton_order<4>(const PointsRef<4>&);
template std::vector<Index> morton_order<5>(const PointsRef<5>&);
template std::vector<Index> morton_order<6>(const PointsRef<6>&);

}  // namespace csrbf
