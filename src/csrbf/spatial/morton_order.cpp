#include "csrbf/spatial/morton_order.hpp"

#include <utility>

namespace csrbf {
namespace {

// Spreads the bits of every coordinate over 63 bits, the first coordinate in the lowest place.
template <int Dim>
std::uint64_t morton_code(const Point<Dim>& unit) {
  constexpr int bits = 63 / Dim < 32 ? 63 / Dim : 32;
  std::uint64_t code = 0;
  for (int axis = 0; axis < Dim; ++axis) {
    const double scaled = std::ldexp(std::clamp(unit[axis], 0.0, 1.0), bits);
    const auto cell = std::min(static_cast<std::uint64_t>(scaled), (std::uint64_t{1} << bits) - 1);
    for (int bit = 0; bit < bits; ++bit) code |= ((cell >> bit) & 1U) << (bit * Dim + axis);
  }
  return code;
}

}  // namespace

template <int Dim>
std::vector<Index> morton_order(const PointsRef<Dim>& points) {
  const Box<Dim> box = bounding_box<Dim>(points);
  const double extent = box.extent().maxCoeff();
  std::vector<std::pair<std::uint64_t, Index>> keyed(static_cast<std::size_t>(points.cols()));
  for (Index i = 0; i < points.cols(); ++i)
    keyed[static_cast<std::size_t>(i)] = {
        morton_code<Dim>(extent > 0 ? Point<Dim>((points.col(i) - box.lo) / extent) : Point<Dim>::Zero()), i};
  std::sort(keyed.begin(), keyed.end());
  std::vector<Index> order(keyed.size());
  for (std::size_t i = 0; i < keyed.size(); ++i) order[i] = keyed[i].second;
  return order;
}

template std::vector<Index> morton_order<1>(const PointsRef<1>&);
template std::vector<Index> morton_order<2>(const PointsRef<2>&);
template std::vector<Index> morton_order<3>(const PointsRef<3>&);
template std::vector<Index> morton_order<4>(const PointsRef<4>&);
template std::vector<Index> morton_order<5>(const PointsRef<5>&);
template std::vector<Index> morton_order<6>(const PointsRef<6>&);

}  // namespace csrbf
