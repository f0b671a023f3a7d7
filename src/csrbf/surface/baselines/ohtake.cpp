#include "csrbf/approx/basis/radial_basis.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/sparse_cholesky.hpp"
#include "csrbf/surface/baselines/baselines.hpp"
#include "csrbf/surface/baselines/quadric_balls.hpp"
#include "csrbf/surface/medial/quadric_fitter.hpp"
#include "csrbf/surface/medial/slope_penalty.hpp"

#include <map>
#include <numeric>
#include <utility>

namespace csrbf::baselines {
namespace {

constexpr double mpu_reach = 0.75;        // radius of a support over the diagonal of its cell (Ohtake et al. 2003)
constexpr std::size_t mpu_samples = 15;   // least number in a support (Ohtake et al. 2003)
constexpr double adaptive_overlap = 1.5;  // least sum of weights at every sample (Ohtake et al. 2004)
// Chosen by hand.
constexpr double multilevel_support = 3;         // cells of the level; larger: smoother, denser systems
constexpr int first_level = 2, most_levels = 9;  // cells of 1/4 to 1/256 of the diagonal
constexpr double multilevel_ridge = 1e-8;        // on the matrix of a level, whose diagonal is 1
constexpr double finest_cell = 2;                // spacings: the last level has cells of at most this size
constexpr double relative_error = 0.1;           // spacings: rms residual of a quadric in MPU and the adaptive method
constexpr int mpu_depth = 10;                    // of the octree
constexpr double adaptive_growth = 1.25;         // factor between supports tried

// Replaces the samples of each cell of a grid by their mean.
OrientedPoints cluster(const OrientedPoints& cloud, double cell) {
  std::map<std::array<Index, 3>, std::vector<Index>> cells;
  for (Index i = 0; i < cloud.size(); ++i) {
    std::array<Index, 3> key{};
    for (Index c = 0; c < 3; ++c) key[c] = static_cast<Index>(std::floor(cloud.points(c, i) / cell));
    cells[key].push_back(i);
  }
  const auto n = static_cast<Index>(cells.size());
  OrientedPoints means{Points<3>(3, n), Points<3>(3, n), Eigen::VectorXd(n)};
  Index k = 0;
  for (const auto& [key, ids] : cells) {
    means.points.col(k) = cloud.points(Eigen::all, ids).rowwise().mean();
    const Point<3> normal = cloud.normals(Eigen::all, ids).rowwise().sum();
    means.normals.col(k) = normal.norm() > 0 ? Point<3>(normal.normalized()) : Point<3>(cloud.normals.col(ids[0]));
    means.spacing[k++] = cloud.spacing(ids).norm();
  }
  return means;
}

// Adds a level so that the sum vanishes at the samples of `cloud`.
void add_level(const OrientedPoints& cloud, double support, const Eigen::VectorXd& before, BallBuilder& balls) {
  const Index n = cloud.size();
  const KdTree<3> tree(cloud.points);
  BallTree::Quadrics quadrics(10, n);
  parallel_for(n, 16, [&](Index begin, Index end) {
    QuadricFitter fitter(cloud, tree);
    for (Index i = begin; i < end; ++i) quadrics.col(i) = fitter.fit(cloud.points.col(i), support);
  });
  const RadialBasis<3> basis(Kernel("wendland-c2", 3), cloud.points, Eigen::VectorXd::Constant(1, support));
  const Eigen::SparseMatrix<double, Eigen::RowMajor> Phi = basis.matrix(cloud.points);
  Eigen::VectorXd right = -before;
  for (Index i = 0; i < n; ++i)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator e(Phi, i); e; ++e)
      right[i] -=
          e.value() * evaluate_quadric(quadrics.col(e.col()), cloud.points.col(i) - cloud.points.col(e.col()))[0];
  Eigen::SparseMatrix<double> ridge(n, n);
  ridge.setIdentity();
  SparseCholesky solver;
  if (!solver.factorize(Eigen::SparseMatrix<double>(Phi) + multilevel_ridge * ridge))
    throw SolverFailure("multilevel: the level is not positive definite");
  quadrics.row(0) += solver.solve(right).col(0).transpose();
  for (Index i = 0; i < n; ++i) balls.add(cloud.points.col(i), support, quadrics.col(i));
}

// An octree cell of MPU.
class Octree {
 public:
  Octree(const PreparedCloud& cloud, double tolerance)
      : tree_(*cloud.tree), fitter_(cloud.cloud, *cloud.tree), tolerance_(tolerance) {}

  void refine(const Point<3>& center, double half, int depth) {
    double support = mpu_reach * 2 * half * std::sqrt(3.0);
    tree_.within(center, support, ids_);
    const bool few = ids_.size() < mpu_samples;
    if (few) {
      std::array<Index, mpu_samples> nearest{};
      std::array<double, mpu_samples> squared{};
      const Index found = tree_.nearest(center, mpu_samples, nearest.data(), squared.data());
      support = std::max(support, 1.2 * std::sqrt(squared[found - 1]));
    }
    const QuadricFitter::Quadric quadric = fitter_.fit(center, support);
    if (few || depth == mpu_depth || fitter_.residual() <= tolerance_) {
      balls_.add(center, support, quadric);
      return;
    }
    for (int corner = 0; corner < 8; ++corner) {
      Point<3> child = center;
      for (int c = 0; c < 3; ++c) child[c] += ((corner >> c) & 1) != 0 ? half / 2 : -half / 2;
      refine(child, half / 2, depth + 1);
    }
  }

  [[nodiscard]] const BallBuilder& balls() const { return balls_; }

 private:
  const KdTree<3>& tree_;
  QuadricFitter fitter_;
  double tolerance_;
  std::vector<Index> ids_;
  BallBuilder balls_;
};

MethodFit finish_quadrics(QuadricBalls::Data data, double smoothing) {
  const Index n = data.centers.cols();
  return {std::make_shared<const QuadricBalls>(std::move(data)), n, smoothing};
}

}  // namespace

MethodFit multilevel(const PreparedCloud& cloud, const MethodOptions& options) {
  const double smallest = finest_cell * cloud.cloud.spacing.mean();
  BallBuilder balls;
  QuadricBalls::Data data;
  for (int level = first_level; level < most_levels; ++level) {
    const double cell = std::pow(0.5, level);
    report(options.progress, "fit", static_cast<double>(level) / most_levels);
    const OrientedPoints means = cluster(cloud.cloud, cell);
    Eigen::VectorXd before = Eigen::VectorXd::Constant(means.size(), -1);  // far outside f = -1
    if (data.centers.cols() > 0) before = QuadricBalls(data).evaluate(means.points).value;
    add_level(means, multilevel_support * cell, before, balls);
    data = balls.data();
    data.normalized = false;
    data.constant = -1;
    if (cell < smallest) break;
  }
  return finish_quadrics(std::move(data), multilevel_ridge);
}

MethodFit mpu(const PreparedCloud& cloud, const MethodOptions& /*options*/) {
  const Box<3> box = bounding_box<3>(cloud.cloud.points);
  Octree octree(cloud, relative_error * cloud.cloud.spacing.mean());
  octree.refine(box.center(), 0.55 * box.extent().maxCoeff(), 0);
  return finish_quadrics(octree.balls().data(), 0);
}

MethodFit adaptive(const PreparedCloud& cloud, const MethodOptions& options) {
  const OrientedPoints& samples = cloud.cloud;
  const double spacing = samples.spacing.mean(), tolerance = relative_error * spacing;
  QuadricFitter fitter(samples, *cloud.tree);
  Eigen::VectorXd covered = Eigen::VectorXd::Zero(samples.size());
  BallBuilder balls;
  // A step coprime to n, near the golden section, visits all samples without consecutive neighbours.
  Index step = std::max<Index>(1, static_cast<Index>(0.6180339887 * static_cast<double>(samples.size())));
  while (std::gcd(step, samples.size()) != 1) ++step;
  for (Index k = 0, i = 0; k < samples.size(); ++k, i = (i + step) % samples.size()) {
    if (covered[i] >= adaptive_overlap) continue;
    const Point<3> center = samples.points.col(i);
    double support = 3 * spacing;
    QuadricFitter::Quadric quadric = fitter.fit(center, support);
    while (support < 0.5) {
      const QuadricFitter::Quadric enlarged = fitter.fit(center, adaptive_growth * support);
      if (fitter.residual() > tolerance) break;
      quadric = enlarged;
      support *= adaptive_growth;
    }
    fitter.fit(center, support);
    for (const Index j : fitter.samples()) {
      const double r = (samples.points.col(j) - center).norm() / support, a = 1 - r;
      covered[j] += a * a * a * a * (4 * r + 1);
    }
    balls.add(center, support, quadric);
  }
  QuadricBalls::Data data = balls.data();
  const SlopeSolution solution = solve_slope_system(
      slope_system({data.centers, data.supports, data.quadrics, {}, 1}, samples.points, samples.normals),
      options.smoothing.value_or(1e-3), options.progress);
  data.quadrics.row(0) += solution.alpha.transpose();
  return finish_quadrics(std::move(data), solution.smoothing);
}

}  // namespace csrbf::baselines
