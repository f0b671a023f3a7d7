#include "csrbf/surface/normals/thin_sheets.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/surface/normals/neighborhood.hpp"

#include <numeric>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index sheet_points = 48;      // about four rings on both sheets
constexpr Index shared_by = 3;          // points that share a neighbourhood, if they are in its inner half
constexpr Index sampled_places = 300;   // that show whether there are such sheets
constexpr double least_share = 0.05;    // ... of them
constexpr int turns = 4;                // of sides and quadrics in turns
constexpr double scattered = 0.4;       // largest deviation from the sheets over half their distance; 0.75 for noise
constexpr double coefficients = 7;      // of two parallel quadrics
constexpr double on_a_sheet = 0.5;      // ... of a single point
constexpr Index sheet_neighbors = 24;   // that tell whether normals know both sheets of a thin part ...
constexpr double clear_majority = 0.5;  // ... by their sides: at least three quarters are the same
constexpr double few_contradictions = 0.08;  // share of the points

// Two parallel sheets through the points near a place.
class SheetFitter {
 public:
  SheetFitter(const Points<3>& points, const KdTree<3>& tree)
      : points_(points), near_(points, tree), moved_(3, sheet_points), ids_(sheet_points) {
    std::iota(ids_.begin(), ids_.end(), Index{0});
  }

  // Whether there are any.
  bool fit(const Point<3>& place) {
    near_.query(place, sheet_points);
    const std::span<const Index> ids = near_.ids();
    if (std::ssize(ids) < sheet_points || near_.frame().is_line()) return false;
    const Point<3> axis = near_.frame().axes.col(0);
    quadric_ = near_.quadric();
    for (int round = 0;; ++round) {
      double sum = 0, squares = 0;
      for (Index k = 0; k < sheet_points; ++k) {
        height_[k] = quadric_.height(points_.col(ids[k]));
        sum += std::abs(height_[k]) / sheet_points;
        squares += height_[k] * height_[k] / sheet_points;
      }
      half_distance_ = sum;
      const double variance = squares - sum * sum;
      deviation_ = std::sqrt(std::max(0.0, variance) * sheet_points / (sheet_points - coefficients));
      if (round == turns) return variance < scattered * scattered * sum * sum;
      for (Index k = 0; k < sheet_points; ++k)
        moved_.col(k) = points_.col(ids[k]) - std::copysign(half_distance_, height_[k]) * axis;
      quadric_ = fit_quadric(moved_, ids_, near_.d2(), near_.frame());
    }
  }

  // Whether the point p is in the inner half of the neighbourhood.
  [[nodiscard]] bool knows(const Point<3>& p) const {
    return (p - near_.frame().center).squaredNorm() < 0.25 * near_.frame().h * near_.frame().h;
  }

  // Standard deviation of the points from the sheets.
  [[nodiscard]] double deviation() const { return deviation_; }

  // The normal at the point p, near the place, away from the other sheet; zero if p is on none of them.
  [[nodiscard]] Point<3> normal(const Point<3>& p) const {
    const double height = quadric_.height(p);
    if (std::abs(std::abs(height) - half_distance_) > on_a_sheet * half_distance_) return Point<3>::Zero();
    return std::copysign(1.0, height) * quadric_.normal(p);
  }

 private:
  const Points<3>& points_;
  Neighborhood near_;
  Points<3> moved_;  // onto the quadric in the middle
  std::vector<Index> ids_;
  std::array<double, sheet_points> height_{};
  LocalQuadric quadric_;
  double half_distance_ = 0, deviation_ = 0;
};

// Standard deviations from the sheets at those of some hundred places that have any.
std::vector<double> deviations(const Points<3>& points, const KdTree<3>& tree) {
  const Index count = std::min(sampled_places, points.cols());
  std::vector<double> found(count, -1);
  parallel_for(count, 32, [&](Index begin, Index end) {
    SheetFitter fitter(points, tree);
    for (Index s = begin; s < end; ++s)
      if (fitter.fit(points.col((2 * s + 1) * points.cols() / (2 * count)))) found[s] = fitter.deviation();
  });
  std::erase(found, -1);
  return found;
}

}  // namespace

ThinSheets thin_sheets(const Points<3>& points, const KdTree<3>& tree) {
  ThinSheets sheets;
  std::vector<double> found = deviations(points, tree);
  if (static_cast<double>(found.size()) <= least_share * static_cast<double>(std::min(sampled_places, points.cols())))
    return sheets;
  sheets.noise = median(std::move(found));
  sheets.normals.setZero(3, points.cols());
  const Index groups = (points.cols() - 1) / shared_by + 1;
  parallel_for(groups, 128, [&](Index begin, Index end) {
    SheetFitter fitter(points, tree);
    for (Index group = begin; group < end; ++group) {
      const Index first = group * shared_by, last = std::min(points.cols(), first + shared_by);
      bool thin = fitter.fit(points.col(first));
      for (Index i = first; i < last; ++i) {
        if (!fitter.knows(points.col(i))) thin = fitter.fit(points.col(i));
        if (thin) sheets.normals.col(i) = fitter.normal(points.col(i));
      }
    }
  });
  return sheets;
}

bool contradict(const Points<3>& points, const KdTree<3>& tree, const Points<3>& normals, const ThinSheets& sheets) {
  if (!sheets.any()) return false;
  Eigen::VectorXd side(points.cols());
  for (Index i = 0; i < side.size(); ++i) {
    const double cosine = sheets.normals.col(i).dot(normals.col(i));
    side[i] = cosine == 0 ? 0 : std::copysign(1.0, cosine);
  }
  std::vector<char> contradicted(points.cols(), 0);
  parallel_for(points.cols(), 512, [&](Index begin, Index end) {
    std::array<Index, sheet_neighbors> ids;
    std::array<double, sheet_neighbors> squared;
    for (Index i = begin; i < end; ++i) {
      if (side[i] == 0) continue;
      const Index found = tree.nearest(points.col(i), sheet_neighbors, ids.data(), squared.data());
      double sum = 0, count = 0;
      for (Index k = 0; k < found; ++k) {
        sum += side[ids[k]];
        count += std::abs(side[ids[k]]);
      }
      contradicted[i] = 2 * count >= sheet_neighbors && std::abs(sum) < clear_majority * count ? 1 : 0;
    }
  });
  return static_cast<double>(std::count(contradicted.begin(), contradicted.end(), 1)) >=
         few_contradictions * static_cast<double>(points.cols());
}

}  // namespace csrbf
