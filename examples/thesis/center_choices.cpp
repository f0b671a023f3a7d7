#include "center_choices.hpp"

#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <numeric>
#include <queue>
#include <random>

namespace csrbf::thesis {
namespace {

constexpr int lloyd_steps = 10;

std::vector<Index> everything(Index n) {
  std::vector<Index> ids(n);
  std::iota(ids.begin(), ids.end(), Index{0});
  return ids;
}

std::vector<Index> random_samples(Index n, Index count) {
  std::vector<Index> ids = everything(n);
  std::mt19937_64 random(5);
  std::shuffle(ids.begin(), ids.end(), random);
  ids.resize(count);
  return ids;
}

// The samples nearest to the means; a sample that is taken gives way to the next.
std::vector<Index> nearest_samples(const Points<3>& points, const Points<3>& means) {
  const KdTree<3> tree(points);
  std::vector<bool> taken(points.cols(), false);
  std::vector<Index> ids;
  for (Index i = 0; i < means.cols(); ++i) {
    for (Index k = 1;; k = std::min(2 * k, points.cols())) {
      std::vector<Index> near(k);
      std::vector<double> squared(near.size());
      tree.nearest(means.col(i), k, near.data(), squared.data());
      const auto free = std::find_if(near.begin(), near.end(), [&](Index id) { return !taken[id]; });
      if (free == near.end()) continue;
      taken[*free] = true;
      ids.push_back(*free);
      break;
    }
  }
  return ids;
}

Points<3> pca_means(const Points<3>& points, Index count) {
  struct Part {
    double spread;
    std::vector<Index> ids;
    Point<3> mean, axis;
    bool operator<(const Part& other) const { return spread < other.spread; }
  };
  const auto make = [&](std::vector<Index> ids) {
    const Points<3> own = points(Eigen::all, ids);
    const Point<3> mean = own.rowwise().mean();
    const Points<3> centered = own.colwise() - mean;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(centered * centered.transpose());
    const double spread = ids.size() > 1 ? axes.eigenvalues()[2] : -1;
    return Part{spread, std::move(ids), mean, axes.eigenvectors().col(2)};
  };
  std::priority_queue<Part> parts;
  parts.push(make(everything(points.cols())));
  while (static_cast<Index>(parts.size()) < count) {
    Part part = parts.top();
    parts.pop();
    const auto middle = std::partition(part.ids.begin(), part.ids.end(),
                                       [&](Index id) { return part.axis.dot(points.col(id) - part.mean) < 0; });
    parts.push(make({part.ids.begin(), middle}));
    parts.push(make({middle, part.ids.end()}));
  }
  Points<3> means(3, count);
  for (Index i = 0; i < count; ++i, parts.pop()) means.col(i) = parts.top().mean;
  return means;
}

Points<3> k_means(const Points<3>& points, Index count) {
  Points<3> means = points(Eigen::all, random_samples(points.cols(), count));
  for (int step = 0; step < lloyd_steps; ++step) {
    const KdTree<3> tree(means);
    Points<3> sums = Points<3>::Zero(3, count);
    Eigen::VectorXd counts = Eigen::VectorXd::Zero(count);
    for (Index i = 0; i < points.cols(); ++i) {
      Index nearest = 0;
      double squared = 0;
      tree.nearest(points.col(i), 1, &nearest, &squared);
      sums.col(nearest) += points.col(i);
      counts[nearest] += 1;
    }
    Points<3> next = means;
    for (Index i = 0; i < count; ++i)
      if (counts[i] > 0) next.col(i) = sums.col(i) / counts[i];
    means = next;
  }
  return means;
}

}  // namespace

std::string name_of(CenterChoice choice) {
  switch (choice) {
    case CenterChoice::random:
      return "random";
    case CenterChoice::pca:
      return "PCA";
    case CenterChoice::k_means:
      return "k-means";
    case CenterChoice::furthest:
      break;
  }
  return "furthest points";
}

std::vector<Index> choose_centers(CenterChoice choice, const Points<3>& points, Index count) {
  std::vector<Index> ids;
  if (choice == CenterChoice::random) ids = random_samples(points.cols(), count);
  if (choice == CenterChoice::pca) ids = nearest_samples(points, pca_means(points, count));
  if (choice == CenterChoice::k_means) ids = nearest_samples(points, k_means(points, count));
  if (choice == CenterChoice::furthest) ids = farthest_points<3>(points, count).indices;
  std::sort(ids.begin(), ids.end());
  return ids;
}

}  // namespace csrbf::thesis
