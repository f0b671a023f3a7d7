#include "csrbf/approx/samples/spacing.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/kd_tree.hpp"

namespace csrbf {

template <int Dim>
double center_spacing(const PointsRef<Dim>& samples, const PointsRef<Dim>& centers) {
  const KdTree<Dim> tree(centers);
  Eigen::VectorXd squared = Eigen::VectorXd::Zero(samples.cols());
  parallel_for(samples.cols(), 1024, [&](Index first, Index last) {
    for (Index i = first; i < last; ++i) {
      Index index[2];
      double distance[2];
      const Index found = tree.nearest(samples.col(i), 2, index, distance);
      if (found > 0) squared[i] = distance[0] > 0 || found == 1 ? distance[0] : distance[1];
    }
  });
  const double largest = samples.cols() == 0 ? 0 : std::sqrt(squared.maxCoeff());
  return largest > 0 ? largest : 1;
}

#define CSRBF_INSTANTIATE(Dim) template double center_spacing<Dim>(const PointsRef<Dim>&, const PointsRef<Dim>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
