#include "csrbf/surface/composite/thinnest_parts.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index measured = 3000;   // samples
constexpr double share = 0.02;     // of them that may be on thinner parts
constexpr Index neighbors = 24;    // of a sample: about two rings on both sheets
constexpr double opposite = -0.7;  // cosine of 135 degrees: creases are no thin parts
constexpr double beside = 1.5;     // spacings along the sheet, up to which a sample shows the other one
constexpr std::size_t fewest = 2;  // samples that show it

// Depth of the sheet below sample i that faces the other way; infinity if there is none near it.
double thickness(const OrientedPoints& cloud, const KdTree<3>& tree, Index i) {
  std::array<Index, neighbors> ids;
  std::array<double, neighbors> squared;
  const Point<3> x = cloud.points.col(i), normal = cloud.normals.col(i);
  const Index found = tree.nearest(x, neighbors, ids.data(), squared.data());
  std::vector<double> depths;
  for (Index k = 0; k < found; ++k) {
    if (!(cloud.normals.col(ids[k]).dot(normal) < opposite)) continue;
    const Point<3> step = cloud.points.col(ids[k]) - x;
    const double depth = -step.dot(normal);
    if (depth > 0 && step.squaredNorm() - depth * depth < beside * beside * cloud.spacing[i] * cloud.spacing[i])
      depths.push_back(depth);
  }
  return depths.size() < fewest ? std::numeric_limits<double>::infinity() : median(depths);
}

}  // namespace

double thinnest_parts(const OrientedPoints& cloud, const KdTree<3>& tree, double least) {
  const Index count = std::min(measured, cloud.size());
  std::vector<double> thick(count);
  parallel_for(count, 64, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) {
      const double t = thickness(cloud, tree, (2 * k + 1) * cloud.size() / (2 * count));
      thick[k] = t < least ? std::numeric_limits<double>::infinity() : t;
    }
  });
  return order_statistic(std::move(thick), static_cast<std::ptrdiff_t>(share * static_cast<double>(count)));
}

}  // namespace csrbf
