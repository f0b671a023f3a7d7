#include "csrbf/surface/normals/winding_sides.hpp"

#include "csrbf/surface/winding/winding_number.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index probed = 4000;        // points
constexpr double beside = 2;          // spacings: beyond the smoothing of w and the gap between bodies that touch
constexpr std::size_t judged = 2000;  // points that have free places
constexpr double free_from = 1.2;     // spacings: least distance of such a place from all points

// Of u = 2 w - 1.
double defect_of(const Eigen::ArrayXd& u) {
  return (1 - u.abs()).square().mean();
}

}  // namespace

WindingSides winding_sides(const Points<3>& points, const Points<3>& normals, const Eigen::VectorXd& spacing,
                           const Points<3>& places) {
  const WindingNumber winding(points, normals, spacing.cwiseAbs2(), spacing);
  const auto some = Eigen::seq(0, points.cols() - 1, std::max<Index>(1, points.cols() / probed));
  const Points<3> middle = points(Eigen::all, some);
  const Points<3> step = beside * normals(Eigen::all, some) * spacing(some).asDiagonal();
  WindingSides result;
  for (const double side : {-1.0, 1.0}) {
    const Points<3> probes = middle + side * step;
    const Eigen::ArrayXd u = winding.evaluate(PointsRef<3>(probes)).value;
    result.mean += (1 + u.mean()) / 4;
    result.defect += defect_of(u) / 2;
  }
  if (places.cols() > 0) result.defect = defect_of(winding.evaluate(PointsRef<3>(places)).value);
  result.energy = winding.evaluate(PointsRef<3>(middle)).value.squaredNorm() / static_cast<double>(middle.cols());
  return result;
}

Points<3> free_places(const Points<3>& points, const KdTree<3>& tree, const Points<3>& normals,
                      const Eigen::VectorXd& spacing) {
  std::vector<Index> ids;
  for (Index i = 0; i < points.cols(); ++i)
    if (normals.col(i).squaredNorm() > 0) ids.push_back(i);
  Points<3> places(3, 2 * std::ssize(ids));
  Index count = 0, nearest = 0;
  double squared = 0;
  for (std::size_t k = 0; k < ids.size(); k += 1 + ids.size() / judged)
    for (const double side : {-1.0, 1.0}) {
      const Index i = ids[k];
      const Point<3> place = points.col(i) + side * beside * spacing[i] * normals.col(i);
      tree.nearest(place, 1, &nearest, &squared);
      if (std::sqrt(squared) > free_from * spacing[i]) places.col(count++) = place;
    }
  places.conservativeResize(3, count);
  return places;
}

double winding_defect(const Points<3>& points, const Points<3>& normals, const Eigen::VectorXd& spacing,
                      const Points<3>& places) {
  const WindingNumber winding(points, normals, spacing.cwiseAbs2(), spacing);
  return defect_of(winding.evaluate(PointsRef<3>(places)).value);
}

}  // namespace csrbf
