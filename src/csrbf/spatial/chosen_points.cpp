#include "csrbf/spatial/chosen_points.hpp"

namespace csrbf {

template <int Dim>
Points<Dim> chosen_points(const PointsRef<Dim>& points, const std::vector<Index>& ids) {
  Points<Dim> result(Dim, std::ssize(ids));
  for (std::size_t i = 0; i < ids.size(); ++i)
    for (int a = 0; a < Dim; ++a) result(a, static_cast<Index>(i)) = points(a, ids[i]);
  return result;
}

template <int Dim>
Points<Dim> in_units(const PointsRef<Dim>& points, const Point<Dim>& origin, double scale) {
  Points<Dim> result(Dim, points.cols());
  for (Index i = 0; i < points.cols(); ++i)
    for (int a = 0; a < Dim; ++a) result(a, i) = (points(a, i) - origin[a]) / scale;
  return result;
}

#define CSRBF_INSTANTIATE(Dim)                                                               \
  template Points<Dim> chosen_points<Dim>(const PointsRef<Dim>&, const std::vector<Index>&); \
  template Points<Dim> in_units<Dim>(const PointsRef<Dim>&, const Point<Dim>&, double);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
