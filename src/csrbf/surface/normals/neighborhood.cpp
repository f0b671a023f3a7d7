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
constexpr double rough = 0.65;         // ... or a rough one; in noise wider than the neighbourhood 0.75 and more ...
constexpr double next_sheet = 1.15;    // ... which ends where the thickness is this many times its least
constexpr double thinnest = 0.01;      // floor of the thickness: less is rounding
constexpr double same_sheet = 0.5;     // cosine between normals
constexpr double alike = 0.8;          // ... of points that share a quadric
constexpr Index refit_share = 16;      // ... at most this share of those it is fitted to
constexpr Index fewest_refitted = 12;  // points of a quadric
constexpr double coefficients = 6;     // of a quadric
constexpr Index max_neighbors = 256;   // at which doubling for neighbours on a line ends

bool on_sheet(const Points<3>& normals, Index i, Index j) {
  return normals.col(i).dot(normals.col(j)) > same_sheet;
}

// Median of (l0 / l1)^(1/2) over a sample of the points; with normals, of neighbours on the same sheet.
double thickness(const Points<3>& points, const KdTree<3>& tree, Index neighbors, const Points<3>* normals) {
  const Index count = std::min(sampled_points, points.cols());
  std::vector<double> ratio(count);
  const auto compute = [&](Index begin, Index end) {
    Neighborhood near(points, tree);
    for (Index s = begin; s < end; ++s) {
      const Index i = (2 * s + 1) * points.cols() / (2 * count);
      near.query(points.col(i), neighbors);
      if (normals != nullptr) near.keep_if([&](Index j) { return on_sheet(*normals, i, j); });
      const Eigen::Vector3d& l = near.frame().eigenvalues;
      ratio[s] = l[1] > 0 ? std::sqrt(std::max(0.0, l[0]) / l[1]) : 1.0;
    }
  };
  parallel_for(count, 32, compute);
  return median(ratio);
}

NeighborChoice choose(const Points<3>& points, const KdTree<3>& tree, const Points<3>* normals) {
  NeighborChoice best{choices[0]};
  Index tried = 0;
  double least = std::numeric_limits<double>::infinity(), least_rough = rough;
  for (const Index choice : choices) {
    if (choice > choices[0] && 16 * choice > points.cols()) break;
    tried = choice;
    const double thick = std::max(thinnest, thickness(points, tree, choice, normals));
    const double criterion = thick * std::cbrt(static_cast<double>(choice));
    if (std::isinf(least) && thick >= flat) {
      if (thick < least_rough || least_rough == rough) best = {.neighbors = choice, .rough = true};
      least_rough = std::min(least_rough, thick);
      if (thick > next_sheet * least_rough && least_rough < rough) break;
    } else if (criterion < least) {
      least = criterion;
      best = {.neighbors = choice};
    } else if (criterion > stop_ratio * least) {
      break;
    }
  }
  best.suits = best.neighbors < tried;
  return best;
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

NeighborChoice choose_neighbors(const Points<3>& points, const KdTree<3>& tree) {
  return choose(points, tree, nullptr);
}

Index refit_normals(const Points<3>& points, const KdTree<3>& tree, Points<3>& normals) {
  const Index neighbors = choose(points, tree, &normals).neighbors;
  const Points<3> before = normals;
  const Index share = std::max<Index>(1, neighbors / refit_share), groups = (points.cols() - 1) / share + 1;
  parallel_for(groups, std::max<Index>(1, 512 / share), [&](Index first, Index last) {
    Neighborhood near(points, tree);
    std::vector<Index> left;
    // Those near point i whose normals are like its own.
    const auto refit_around = [&](Index i) {
      near.query(points.col(i), neighbors);
      near.keep_if([&](Index j) { return on_sheet(before, i, j); });
      const bool enough = std::ssize(near.ids()) >= fewest_refitted && near.frame().is_surface();
      const LocalQuadric quadric = enough ? near.quadric() : LocalQuadric{};
      const double reach2 = near.ids().empty() ? 0 : 0.25 * near.d2().back();
      std::erase_if(left, [&](Index j) {
        const bool known =
            before.col(i).dot(before.col(j)) > alike && (points.col(j) - points.col(i)).squaredNorm() < reach2;
        if (known && enough) {
          const Point<3> normal = quadric.normal(points.col(j));
          normals.col(j) = normal.dot(before.col(j)) < 0 ? Point<3>(-normal) : normal;
        }
        return known || j == i;
      });
    };
    for (Index i = first * share; i < std::min(points.cols(), last * share); ++i) {
      left.push_back(i);
      if ((i + 1) % share == 0 || i + 1 == points.cols())
        while (!left.empty()) refit_around(left[left.size() / 2]);
    }
  });
  return neighbors;
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
