#include "csrbf/spatial/coincident_points.hpp"

#include "csrbf/core/dimensions.hpp"

#include <bit>
#include <cstdint>

namespace csrbf {
namespace {

// The bits of all coordinates, mixed; adding 0 makes -0 the same as 0.
template <int Dim>
std::uint64_t hash(const double* p) {
  std::uint64_t h = 0;
  for (int a = 0; a < Dim; ++a)
    h = (std::rotl(h, 23) ^ std::bit_cast<std::uint64_t>(p[a] + 0.0)) * 0x9E3779B97F4A7C15ULL;
  return h ^ h >> 32U;
}

}  // namespace

template <int Dim>
std::vector<Index> first_coincident(const PointsRef<Dim>& points) {
  const auto n = static_cast<std::size_t>(points.cols());
  std::vector<Index> first(n), slot(std::bit_ceil(2 * n + 1), -1);  // an open table
  const std::size_t mask = slot.size() - 1;
  for (std::size_t i = 0; i < n; ++i) {
    const Point<Dim> p = points.col(static_cast<Index>(i));
    std::size_t s = hash<Dim>(p.data()) & mask;
    while (slot[s] >= 0 && points.col(slot[s]) != p) s = (s + 1) & mask;
    if (slot[s] < 0) slot[s] = static_cast<Index>(i);
    first[i] = slot[s];
  }
  return first;
}

#define CSRBF_INSTANTIATE(Dim) template std::vector<Index> first_coincident<Dim>(const PointsRef<Dim>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
