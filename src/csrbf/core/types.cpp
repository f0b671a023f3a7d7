#include "csrbf/core/types.hpp"

#include "csrbf/core/dimensions.hpp"
#include "csrbf/core/parallel.hpp"

#include <vector>

namespace csrbf {

template <int Dim>
Box<Dim> bounding_box(const PointsRef<Dim>& points) {
  constexpr Index grain = 1 << 14;
  std::vector<Box<Dim>> parts(static_cast<std::size_t>((points.cols() + grain - 1) / grain));
  parallel_for(points.cols(), grain, [&](Index begin, Index end) {
    const auto some = points.middleCols(begin, end - begin);
    parts[static_cast<std::size_t>(begin / grain)] = {some.rowwise().minCoeff(), some.rowwise().maxCoeff()};
  });
  Box<Dim> box;
  for (const Box<Dim>& part : parts) box.add(part);
  return box;
}

#define CSRBF_INSTANTIATE(Dim) template Box<Dim> bounding_box<Dim>(const PointsRef<Dim>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
