#include "csrbf/spatial/coincident_points.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/numbers/bit_cast.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/radix_sort.hpp"

#include <bit>

namespace csrbf {
namespace {

constexpr Index points_per_task = 1 << 14;  // points per task, chosen by hand

// The bits of all coordinates, hashed by multiplication with 2^64 over the golden ratio; adding 0 turns -0 into 0.
template <int Dim>
std::uint64_t hash(const double* p) {
  std::uint64_t h = 0;
  for (int a = 0; a < Dim; ++a) h = (std::rotl(h, 23) ^ bit_cast<std::uint64_t>(p[a] + 0.0)) * 0x9E3779B97F4A7C15ULL;
  return h ^ h >> 32U;
}

// Points with equal keys become neighbours, in input order.
template <int Dim>
std::vector<Keyed> sort_by_hash(const PointsRef<Dim>& points) {
  constexpr int spare_bits = 2;  // beyond log2 n, so that few distinct points share a key; chosen by hand
  const auto n = static_cast<std::size_t>(points.cols());
  const int bits = std::min(32, static_cast<int>(std::bit_width(n)) + spare_bits);
  const auto limit = static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
  std::vector<Keyed> items(n);
  parallel_for(points.cols(), points_per_task, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Point<Dim> p = points.col(i);
      items[i] = {static_cast<std::uint32_t>(hash<Dim>(p.data())) & limit, static_cast<std::uint32_t>(i)};
    }
  });
  radix_sort(items, limit);
  return items;
}

}  // namespace

template <int Dim>
std::vector<Index> first_coincident(const PointsRef<Dim>& points) {
  const auto n = static_cast<std::size_t>(points.cols());
  require(n <= std::numeric_limits<std::uint32_t>::max(), "first_coincident", "points", n, "must be fewer than 2^32");
  const std::vector<Keyed> items = sort_by_hash<Dim>(points);
  std::vector<Index> first(n);
  parallel_for(points.cols(), points_per_task, [&](Index range_begin, Index range_end) {
    std::vector<std::uint32_t> distinct;  // points of a key
    for (Index begin = range_begin; begin < range_end; ++begin) {
      const std::uint32_t key = items[begin].key;
      if (begin > 0 && items[begin - 1].key == key) continue;
      distinct.clear();
      for (Index k = begin; k < points.cols() && items[k].key == key; ++k) {
        const std::uint32_t i = items[k].index;
        first[i] = i;
        if (points.col(i).hasNaN()) continue;
        const auto same = std::find_if(distinct.begin(), distinct.end(),
                                       [&](std::uint32_t j) { return points.col(j) == points.col(i); });
        if (same == distinct.end())
          distinct.push_back(i);
        else
          first[i] = *same;
      }
    }
  });
  return first;
}

#define CSRBF_INSTANTIATE(Dim) template std::vector<Index> first_coincident<Dim>(const PointsRef<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
