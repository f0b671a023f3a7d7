#include "csrbf/spatial/morton_order.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/morton_code.hpp"
#include "csrbf/spatial/radix_sort.hpp"

#include <bit>
#include <utility>

namespace csrbf {
namespace {

constexpr Index grain = 8192;  // points per task, chosen by hand

template <int Dim>
constexpr int most_bits = std::min(32, 63 / Dim);  // per coordinate, of a code of at most 64 bits

// Of the cube that holds a point of the unit cube, of 2^bits cubes along each axis.
template <int Dim>
std::uint64_t code_of(const Point<Dim>& unit, int bits) {
  const auto cells = static_cast<double>(std::uint64_t{1} << bits);
  std::array<std::uint64_t, Dim> cell;
  for (int axis = 0; axis < Dim; ++axis) {
    const double scaled = unit[axis] * cells;
    cell[axis] = scaled > 0 ? static_cast<std::uint64_t>(std::min(scaled, cells - 1)) : 0;  // 0 also for NaN
  }
  return morton_code<Dim>(cell, bits);
}

// Calls action(i, code) for every point i, on all threads.
template <int Dim, class Action>
void for_each_code(const PointsRef<Dim>& points, int bits, const Action& action) {
  const Box<Dim> box = bounding_box<Dim>(points);
  const double extent = box.extent().maxCoeff();
  parallel_for(points.cols(), grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) action(i, code_of<Dim>((points.col(i) - box.lo) / extent, bits));
  });
}

std::vector<Index> indices_of(const std::vector<Keyed>& items) {
  std::vector<Index> indices(items.size());
  parallel_for(std::ssize(items), grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) indices[i] = items[i].index;
  });
  return indices;
}

bool has_longer_run(const std::vector<Keyed>& sorted, std::size_t length) {
  for (std::size_t i = length; i < sorted.size(); ++i)
    if (sorted[i].key == sorted[i - length].key) return true;
  return false;
}

}  // namespace

template <int Dim>
std::vector<Index> morton_order(const PointsRef<Dim>& points) {
  const auto n = static_cast<std::size_t>(points.cols());
  require(n <= std::numeric_limits<std::uint32_t>::max(), "morton_order", "points", n, "must be fewer than 2^32");
  constexpr int low_bits = std::max(0, most_bits<Dim> * Dim - 32);
  std::vector<std::uint64_t> code(n);
  std::vector<Keyed> items(n);
  for_each_code<Dim>(points, most_bits<Dim>, [&](Index i, std::uint64_t its_code) {
    code[i] = its_code;
    items[i] = {static_cast<std::uint32_t>(its_code >> low_bits), static_cast<std::uint32_t>(i)};
  });
  radix_sort(items);
  for (std::size_t begin = 0, end = 0; begin < n; begin = end) {  // ties of the keys, by the full codes
    for (end = begin + 1; end < n && items[end].key == items[begin].key;) ++end;
    if (end - begin > 1)
      std::sort(items.data() + begin, items.data() + end, [&](const Keyed& a, const Keyed& b) {
        return std::pair(code[a.index], a.index) < std::pair(code[b.index], b.index);
      });
  }
  return indices_of(items);
}

template <int Dim>
std::vector<Index> rough_morton_order(const PointsRef<Dim>& points) {
  constexpr std::size_t largest_cube = 256;  // points; a cube with more is too coarse. Chosen by hand
  constexpr int extra_bits = 2;              // four times as many cubes as points; chosen by hand
  const auto n = static_cast<std::size_t>(points.cols());
  require(n <= std::numeric_limits<std::uint32_t>::max(), "rough_morton_order", "points", n, "must be fewer than 2^32");
  const int bits = std::clamp((static_cast<int>(std::bit_width(n)) + extra_bits) / Dim, 1, 32 / Dim);
  std::vector<Keyed> items(n);
  for_each_code<Dim>(points, bits, [&](Index i, std::uint64_t code) {
    items[i] = {static_cast<std::uint32_t>(code), static_cast<std::uint32_t>(i)};
  });
  radix_sort(items, static_cast<std::uint32_t>((std::uint64_t{1} << (bits * Dim)) - 1));
  return has_longer_run(items, largest_cube) ? morton_order<Dim>(points) : indices_of(items);
}

#define CSRBF_INSTANTIATE(Dim)                                          \
  template std::vector<Index> morton_order<Dim>(const PointsRef<Dim>&); \
  template std::vector<Index> rough_morton_order<Dim>(const PointsRef<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
