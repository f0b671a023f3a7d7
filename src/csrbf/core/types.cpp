#include "csrbf/core/types.hpp"

#include "csrbf/core/parallel.hpp"

#include <type_traits>
#include <vector>

namespace csrbf {

// Declared in csrbf.hpp.
int compile_csrbf_with_the_same_march(std::integral_constant<int, EIGEN_DEFAULT_ALIGN_BYTES> alignment) {
  return alignment;
}

template <int Dim>
Box<Dim> bounding_box(const PointsRef<Dim>& points) {
  constexpr Index grain = 1 << 14;  // points per task, chosen by hand: fewer are not worth a thread
  const auto box_of = [](const auto& some) {
    Box<Dim> box;
    for (Index i = 0; i < some.cols(); ++i) box.add(Point<Dim>(some.col(i)));
    return box;
  };
  if (points.cols() <= grain) return box_of(points);
  std::vector<Box<Dim>> parts((points.cols() + grain - 1) / grain);
  parallel_for(points.cols(), grain,
               [&](Index begin, Index end) { parts[begin / grain] = box_of(points.middleCols(begin, end - begin)); });
  Box<Dim> box;
  for (const Box<Dim>& part : parts) box.add(part);
  return box;
}

#define CSRBF_INSTANTIATE(Dim) template Box<Dim> bounding_box<Dim>(const PointsRef<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
