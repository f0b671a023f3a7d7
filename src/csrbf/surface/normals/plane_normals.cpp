#include "csrbf/surface/normals/plane_normals.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index fewest_points = 128;                // below, angles are too few
constexpr Index fewest_neighbors = 5;               // in a plane
constexpr Index most_neighbors = 60;                // programs use 6 to 50
constexpr Index first_look = 100;                   // points at which all numbers of neighbours are tried
constexpr Index second_look = 400;                  // ... and the best one
constexpr double close = 0.05;                      // largest ratio: above rounding in files, below thin shells
constexpr std::array<double, 2> shares{0.75, 0.9};  // of the points
constexpr double flat = 0.01;                       // sine of the angle between planes that are the same
constexpr Index fewest_telling = 8;                 // points where planes differ
constexpr double far_apart = 0.7;                   // cosine between estimated and given normals: 45 degrees

Index more(Index k) {
  return 3 * k / 2;
}

// Sines of the angles at one point after the other, for k from `fewest` on.
struct Angles {
  std::vector<double> given, wider;  // between the plane of k points and the normal, and the plane of more
};

// Where planes do not differ, as on flat faces without noise, all normals agree, and tell nothing.
double ratio_of(const Angles& angles) {
  Angles telling;
  for (std::size_t i = 0; i < angles.given.size(); ++i) {
    if (angles.wider[i] < flat) continue;
    telling.given.push_back(angles.given[i]);
    telling.wider.push_back(angles.wider[i]);
  }
  if (std::ssize(telling.given) < fewest_telling) return std::numeric_limits<double>::infinity();
  double ratio = 0;
  for (const double share : shares)
    ratio = std::max(ratio, percentile(telling.given, share) / percentile(telling.wider, share));
  return ratio;
}

class Planes {
 public:
  Planes(const Points<3>& points, const KdTree<3>& tree, const Points<3>& normals, Index fewest, Index most)
      : points_(points), tree_(tree), normals_(normals), fewest_(fewest), most_(most) {}

  // The ratio for every k, from about `count` points.
  [[nodiscard]] std::vector<double> ratios(Index count) const {
    const Index step = std::max<Index>(1, points_.cols() / count), n = (points_.cols() - 1) / step + 1;
    std::vector<Angles> angles(most_ - fewest_ + 1, {std::vector<double>(n), std::vector<double>(n)});
    parallel_for(n, 8, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) look(i * step, i, angles);
    });
    std::vector<double> result;
    result.reserve(angles.size());
    for (const Angles& a : angles) result.push_back(ratio_of(a));
    return result;
  }

 private:
  void look(Index point, Index place, std::vector<Angles>& angles) const {
    const Index widest = more(most_);
    std::vector<Index> ids(widest);
    std::vector<double> squared(ids.size());
    const Point<3> center = points_.col(point);
    tree_.nearest(center, widest, ids.data(), squared.data());
    Points<3> plane(3, widest + 1);
    Point<3> sum = Point<3>::Zero();
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    for (Index k = 1; k <= widest; ++k) {
      const Point<3> d = points_.col(ids[k - 1]) - center;
      sum += d;
      products += d * d.transpose();
      if (k < fewest_) continue;
      const Eigen::Matrix3d covariance = products - sum * sum.transpose() / static_cast<double>(k);
      plane.col(k) = symmetric_eigen_direct(covariance).vectors.col(0);
    }
    for (Index k = fewest_; k <= most_; ++k) {
      const Point<3> p = plane.col(k), wider = plane.col(more(k)), given = normals_.col(point);
      angles[k - fewest_].given[place] = p.cross(given).norm();
      angles[k - fewest_].wider[place] = p.cross(wider).norm();
    }
  }

  const Points<3>& points_;
  const KdTree<3>& tree_;
  const Points<3>& normals_;
  Index fewest_, most_;
};

}  // namespace

Index neighbors_of_planes(const Points<3>& points, const KdTree<3>& tree, const Points<3>& normals) {
  if (points.cols() < fewest_points) return 0;
  const std::vector<double> ratios = Planes(points, tree, normals, fewest_neighbors, most_neighbors).ratios(first_look);
  const auto least = std::min_element(ratios.begin(), ratios.end());
  if (*least > close) return 0;
  const Index best = fewest_neighbors + (least - ratios.begin());
  return Planes(points, tree, normals, best, best).ratios(second_look).front() <= close ? best : 0;
}

Points<3> on_given_side(const Points<3>& estimated, const Points<3>& given, const NeighborTable& near) {
  Points<3> result(3, given.cols());
  parallel_for(given.cols(), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      Point<3> sum = given.col(i);
      for (const std::uint32_t j : near.of(i))
        if (given.col(j).dot(given.col(i)) > 0) sum += given.col(j);
      const Point<3> mean = sum.normalized();
      const double cosine = mean.dot(estimated.col(i));
      result.col(i) = std::abs(cosine) < far_apart ? mean : Point<3>(std::copysign(1.0, cosine) * estimated.col(i));
    }
  });
  return result;
}

}  // namespace csrbf
