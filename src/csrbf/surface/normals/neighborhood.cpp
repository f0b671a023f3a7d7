#include "csrbf/surface/normals/neighborhood.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index choices[] = {16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512};  // numbers of neighbours tried
constexpr Index sampled_points = 300;  // that the choice is made with; more: slower, less random
constexpr double stop_ratio = 1.15;    // a criterion this much larger than the least ends the search
constexpr double flat = 0.4;           // largest thickness, (l0 / l1)^(1/2), of a neighbourhood that shows a surface
constexpr double thinnest = 0.01;      // floor of the thickness: less is rounding
constexpr double coefficients = 6;     // of a quadric
constexpr Index max_neighbors = 256;   // at which doubling for neighbours on a line ends

// Median of (l0 / l1)^(1/2) over a sample of the points.
double thickness(const Points<3>& points, const KdTree<3>& tree, Index neighbors) {
  const Index count = std::min(sampled_points, points.cols());
  std::vector<double> ratio(count);
  const auto compute = [&](Index begin, Index end) {
    Neighborhood near(points, tree);
    for (Index s = begin; s < end; ++s) {
      near.query(points.col((2 * s + 1) * points.cols() / (2 * count)), neighbors);
      const Eigen::Vector3d& l = near.frame().eigenvalues;
      ratio[s] = l[1] > 0 ? std::sqrt(std::max(0.0, l[0]) / l[1]) : 1.0;
    }
  };
  parallel_for(count, 32, compute);
  return median(ratio);
}

}  // namespace

void Neighborhood::query(const Point<3>& center, Index count) {
  count = std::min(count, points_.cols());
  ids_.resize(std::max(std::ssize(ids_), count));
  d2_.resize(ids_.size());
  count_ = static_cast<std::size_t>(tree_.nearest(center, count, ids_.data(), d2_.data()));
  frame_ = local_frame(points_, ids(), d2(), center);
}

void Neighborhood::query_surface(const Point<3>& center, Index count) {
  query(center, count);
  while (!frame_.is_surface() && static_cast<Index>(count_) < std::min(max_neighbors, points_.cols()))
    query(center, count *= 2);
}

double Neighborhood::deviation() const {
  const LocalQuadric fit = quadric();
  double sum = 0, weights = 0;
  for (std::size_t j = 0; j < count_; ++j) {
    const double height = fit.height(points_.col(ids_[j])), w = 1 - d2_[j] / (frame_.h * frame_.h);
    sum += w * height * height;
    weights += w;
  }
  const auto count = static_cast<double>(count_);
  return weights > 0 ? std::sqrt(sum / weights * count / (count - coefficients)) : 0;
}

Index choose_neighbors(const Points<3>& points, const KdTree<3>& tree) {
  Index best = choices[0];
  double least = std::numeric_limits<double>::infinity();
  for (const Index choice : choices) {
    if (choice > choices[0] && 16 * choice > points.cols()) break;
    const double thick = std::max(thinnest, thickness(points, tree, choice));
    const double criterion = thick * std::cbrt(static_cast<double>(choice));
    if (std::isinf(least) && thick >= flat) {
      best = choice;
    } else if (criterion < least) {
      least = criterion;
      best = choice;
    } else if (criterion > stop_ratio * least) {
      break;
    }
  }
  return best;
}

void fit_normals(const Points<3>& points, Index begin, Index end, Index neighbors, Neighborhood& near,
                 Points<3>& normals, NeighborTable& table) {
  const Index count = end - begin;
  const Point<3> center =
      count > 1 ? Point<3>(points.middleCols(begin, count).rowwise().mean()) : Point<3>(points.col(begin));
  near.query_surface(center, neighbors);
  if (count == 1 && table.k > 0) table.set(begin, near.ids(), near.d2().data());
  if (count > 1) {
    const double radius2 = (points.middleCols(begin, count).colwise() - center).colwise().squaredNorm().maxCoeff();
    if (!(radius2 < 0.25 * near.d2().back())) {
      const Index middle = begin + count / 2;
      fit_normals(points, begin, middle, neighbors, near, normals, table);
      fit_normals(points, middle, end, neighbors, near, normals, table);
      return;
    }
  }
  if (near.frame().is_line()) {
    normals.middleCols(begin, count).setZero();
    return;
  }
  const LocalQuadric quadric = near.quadric();
  for (Index i = begin; i < end; ++i) normals.col(i) = quadric.normal(points.col(i));
}

}  // namespace csrbf
