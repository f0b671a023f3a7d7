#include "csrbf/surface/normals/winding_consistency.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/surface/normals/neighborhood.hpp"
#include "csrbf/surface/winding/dipole_sums.hpp"

#include <memory>
#include <utility>

namespace csrbf {
namespace {

using Vectors = winding::DipoleSums::Vectors;

// Chosen by hand.
constexpr Index coarsest = 3000;               // points of the first level at most
constexpr Index level_ratio = 4;               // ratio between levels
constexpr int first_rounds = 16;               // of the first level; this and the next two, more: slower, no better
constexpr int rounds = 8;                      // ... of the others
constexpr int noisy_rounds = 4;                // ... under strong noise
constexpr Index neighbors = 9;                 // for the spacing
constexpr double widest = 1, narrowest = 0.3;  // smoothing lengths in spacings, first and last without noise
constexpr double widest_noise = 1.5;           // ... and the last under strong noise
constexpr double width_of_noise = 4.8;         // last smoothing length in standard deviations of the noise
constexpr double clean_energy = 0.022;         // least with smoothing so narrow: clean clouds have less ...
constexpr double noisy_energy = 0.036;         // ... noisy ones more
constexpr double momentum = 0.7;               // largest share of the last change that is repeated
constexpr double wrong_energy = 0.2;           // on solids, right ones have 0.15 at most, thin walls in noise
constexpr double clearly_lower = 0.8;          // largest ratio of energies
constexpr Index most_direct = 100'000;         // points that start from nothing once more
constexpr double usual_sparseness = 4;         // largest ratio of areas that are taken for equal
constexpr Index noise_points = 300;            // at which noise is measured
constexpr double usual_place = 0.4;            // ... as a share: noise along one axis spares a third of the places
constexpr Index fitted_points = 17;            // ... from the quadric of so many

// Standard deviation of most points from quadrics through their neighbours: noise, or thin parts.
double estimate_noise(const Points<3>& points, const KdTree<3>& tree) {
  const Index n = points.cols(), count = std::min(noise_points, n);
  if (n < fitted_points) return 0;
  std::vector<double> deviations(count);
  parallel_for(count, 32, [&](Index begin, Index end) {
    Neighborhood near(points, tree);
    for (Index s = begin; s < end; ++s) {
      near.query(points.col((2 * s + 1) * n / (2 * count)), fitted_points);
      deviations[s] = near.deviation();
    }
  });
  return percentile(deviations, usual_place);
}

// Normals times areas of the points of one level, in the order of the sums.
class Level {
 public:
  Level(const Points<3>& points, const Eigen::VectorXd& spacing, const Vectors& start)
      : sums_(points),
        spacing_(spacing),
        m_(start(Eigen::all, sums_.order())),
        before_(m_),
        rest_(Eigen::VectorXf::Zero(m_.cols())) {}

  void turn(double width) {
    sums_.set_smoothing(width * spacing_);
    const Eigen::VectorXf rest = 0.5F - sums_.winding(m_).array(), last_change = rest_ - rest;
    const Vectors steepest = sums_.adjoint(rest), last = m_ - before_;
    const Eigen::VectorXf change = sums_.winding(steepest);
    before_ = m_;
    const double aa = change.squaredNorm(), ab = change.dot(last_change), bb = last_change.squaredNorm(),
                 ar = change.dot(rest), br = last_change.dot(rest), determinant = aa * bb - ab * ab;
    const bool independent = rounds_++ > 0 && determinant > 1e-9 * aa * bb;
    const double again = independent ? std::clamp((br * aa - ab * ar) / determinant, 0.0, momentum) : 0;
    m_ += static_cast<float>(again) * last;
    if (aa > 0) m_ += static_cast<float>((ar - ab * again) / aa) * steepest;
    rest_ = rest;
    const Vectors outward = sums_.outward(m_);
    for (Index i = 0; i < m_.cols(); ++i)
      if (const float length = outward.col(i).norm(); length > 0)
        m_.col(i) = m_.col(i).norm() / length * outward.col(i);
  }

  // Mean of (2 w - 1)^2 at the points.
  [[nodiscard]] double energy() const { return 4 * (0.5F - sums_.winding(m_).array()).square().mean(); }

  [[nodiscard]] ConsistentNormals result() {
    ConsistentNormals result{Points<3>::Zero(3, m_.cols())};
    Vectors m = Vectors::Zero(3, m_.cols());
    for (Index i = 0; i < m.cols(); ++i) {
      const Index point = sums_.order()[i];
      const float length = m_.col(i).norm();
      if (!(length > 0)) continue;
      result.normals.col(point) = (m_.col(i) / length).cast<double>();
      m.col(i) = static_cast<float>(spacing_[point] * spacing_[point]) / length * m_.col(i);
    }
    sums_.set_smoothing(widest * spacing_);
    const Eigen::ArrayXf w = sums_.winding(m);
    result.mean_winding = w.mean();
    result.energy = (2 * w - 1).square().mean();
    return result;
  }

 private:
  winding::DipoleSums sums_;
  Eigen::VectorXd spacing_;
  Vectors m_, before_;    // now and before the last round
  Eigen::VectorXf rest_;  // 1/2 - w in the last round
  int rounds_ = 0;
};

// `near`: the neighbours of the points.
ConsistentNormals solve_level(const Points<3>& points, const NeighborTable& near, double noise, bool first,
                              const Points<3>& start) {
  Eigen::VectorXd spacing(points.cols());
  for (Index i = 0; i < points.cols(); ++i) spacing[i] = std::sqrt(near.area(i));
  const double usual = median(std::vector<double>(spacing.begin(), spacing.end()));
  const double width = std::clamp(usual > 0 ? width_of_noise * noise / usual : 0.0, narrowest, widest_noise);
  const Points<3> dipoles = start * spacing.cwiseAbs2().asDiagonal();
  const auto solve = [&](double last) {
    Level level(points, spacing, dipoles.cast<float>());
    const int count = first ? first_rounds : last < widest ? rounds : noisy_rounds;
    for (int left = count; left-- > 0;) level.turn(last + std::max(0.0, widest - last) * left / count);
    return level;
  };
  if (width < 2 * narrowest) return solve(width).result();
  // Thin sheets look like noise, but reach a low energy.
  Level thin = solve(narrowest);
  const double noisy = (thin.energy() - clean_energy) / (noisy_energy - clean_energy);
  return noisy > 0 ? solve(narrowest + std::min(1.0, noisy) * (width - narrowest)).result() : thin.result();
}

// How much more of the surface each point stands for than usual: 1 where that is hardly more or less. From the median
// of its neighbours' areas, for those of points off the surface are too large.
Eigen::VectorXd sparseness(const NeighborTable& near) {
  Eigen::VectorXd areas(near.size());
  parallel_for(near.size(), 1024, [&](Index begin, Index end) {
    std::vector<double> around(near.k);
    for (Index i = begin; i < end; ++i) {
      const auto nearest = near.of(i);
      std::transform(nearest.begin(), nearest.end(), around.begin(), [&](Index j) { return near.area(j); });
      areas[i] = median(around);
    }
  });
  const double usual = median(std::vector<double>(areas.begin(), areas.end()));
  return areas.unaryExpr([&](double area) {
    const double share = area / usual;
    return share < usual_sparseness && share * usual_sparseness > 1 ? 1 : share;
  });
}

// One of `stride` points in Morton order, fewer where they are dense, so that sparse parts keep theirs.
Points<3> even_share(const Points<3>& points, const Eigen::VectorXd& weights, Index stride) {
  const double step = weights.mean() * static_cast<double>(stride);
  std::vector<Index> kept;
  double sum = 0, next = 0;
  for (Index i = 0; i < points.cols(); ++i) {
    if (sum >= next) {
      kept.push_back(i);
      next = step * (std::floor(sum / step) + 1);
    }
    sum += weights[i];
  }
  return points(Eigen::all, kept);
}

// The normal of the nearest point of the level before. `tree`: of that level.
Points<3> start_from(const KdTree<3>& tree, const Points<3>& normals, const Points<3>& points) {
  Points<3> result(3, points.cols());
  parallel_for(points.cols(), 1024, [&](Index begin, Index end) {
    Index nearest = 0;
    double squared = 0;
    for (Index i = begin; i < end; ++i) {
      tree.nearest(points.col(i), 1, &nearest, &squared);
      result.col(i) = normals.col(nearest);
    }
  });
  return result;
}

// Some of the points, which must not move in memory: the tree refers to them.
struct Thinned {
  explicit Thinned(Points<3> some) : points(std::move(some)), tree(points) {}

  Points<3> points;
  KdTree<3> tree;
};

}  // namespace

ConsistentNormals consistent_normals(const Points<3>& points, const KdTree<3>& tree) {
  return consistent_normals(points, tree, estimate_noise(points, tree));
}

ConsistentNormals consistent_normals(const Points<3>& points, const KdTree<3>& tree, double noise) {
  const Index n = points.cols();
  Index stride = 1;
  while (n / stride > coarsest) stride *= level_ratio;
  const NeighborTable near = make_neighbor_table(points, tree, neighbors);
  const Eigen::VectorXd weights = sparseness(near);
  std::unique_ptr<const Thinned> coarse;
  ConsistentNormals result;
  for (bool first = true; stride > 1; stride /= level_ratio, first = false) {
    auto some = std::make_unique<const Thinned>(even_share(points, weights, stride));
    result = solve_level(some->points, make_neighbor_table(some->points, some->tree, neighbors), noise, first,
                         first ? Points<3>(Points<3>::Zero(3, some->points.cols()))
                               : start_from(coarse->tree, result.normals, some->points));
    coarse = std::move(some);
  }
  const Points<3> nothing = Points<3>::Zero(3, n);
  result =
      solve_level(points, near, noise, !coarse, coarse ? start_from(coarse->tree, result.normals, points) : nothing);
  if (n > coarsest && n <= most_direct && result.energy > wrong_energy) {
    ConsistentNormals direct = solve_level(points, near, noise, true, nothing);
    if (direct.energy < clearly_lower * result.energy) result = std::move(direct);
  }
  return result;
}

ConsistentNormals consistent_normals(const Points<3>& points, const KdTree<3>& tree, const Points<3>& start,
                                     double noise) {
  return solve_level(points, make_neighbor_table(points, tree, neighbors), noise, false, start);
}

}  // namespace csrbf
