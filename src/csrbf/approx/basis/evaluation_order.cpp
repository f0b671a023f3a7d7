#include "csrbf/approx/basis/evaluation_order.hpp"

#include "csrbf/spatial/morton_order.hpp"

namespace csrbf {

template <int Dim>
std::vector<Index> evaluation_order_of(const PointsRef<Dim>& x) {
  constexpr Index few = 4096;  // points that are not worth sorting; chosen by hand
  if (x.cols() < few) return {};
  // A step from point to point is about the spacing in a good order and about the size of the domain in a random one.
  constexpr double long_step = 8;  // in mean spacings, chosen by hand
  constexpr Index one_in = 8;      // steps must be long for the points to be sorted; chosen by hand
  const double spacing = bounding_box<Dim>(x).diagonal() * std::pow(static_cast<double>(x.cols()), -1.0 / Dim);
  Index far = 0;
  for (Index i = 1; i < x.cols(); ++i) far += (x.col(i) - x.col(i - 1)).norm() > long_step * spacing ? 1 : 0;
  if (far < x.cols() / one_in) return {};
  return morton_order<Dim>(x);
}

#define CSRBF_INSTANTIATE(Dim) template std::vector<Index> evaluation_order_of<Dim>(const PointsRef<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
