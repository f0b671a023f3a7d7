#include "csrbf/approx/moving/track_directions.hpp"

#include "csrbf/core/parallel.hpp"

namespace csrbf {

template <int Dim>
Points<Dim> track_directions(const Points<Dim>& points, const KdTree<Dim>& tree) {
  constexpr Index neighbors = 24;       // chosen by hand: more find sparser tracks, O(n k^2)
  constexpr double opposite = -0.9903;  // cosine of 172 degrees, chosen by hand: larger angles miss curved tracks
  const Index k = std::min(neighbors + 1, points.cols());
  Points<Dim> directions = Points<Dim>::Zero(Dim, points.cols());
  parallel_for(points.cols(), 256, [&](Index first, Index last) {
    std::vector<Index> found(k);
    std::vector<double> squared(found.size());
    Points<Dim> to(Dim, k);
    Eigen::VectorXd distance(k);
    for (Index i = first; i < last; ++i) {
      tree.nearest(points.col(i), k, found.data(), squared.data());
      Index count = 0;
      for (const Index j : found) {
        if (j == i) continue;
        to.col(count) = points.col(j) - points.col(i);
        distance[count] = to.col(count).norm();
        ++count;
      }
      double shortest = std::numeric_limits<double>::infinity();
      for (Index a = 1; a < count; ++a)
        for (Index b = 0; b < a && distance[a] < shortest; ++b) {
          const double length = distance[a] + distance[b];
          if (length >= shortest || to.col(a).dot(to.col(b)) > opposite * distance[a] * distance[b]) continue;
          shortest = length;
          directions.col(i) = (to.col(a) - to.col(b)).normalized();
        }
    }
  });
  return directions;
}

#define CSRBF_INSTANTIATE(Dim) template Points<Dim> track_directions<Dim>(const Points<Dim>&, const KdTree<Dim>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
