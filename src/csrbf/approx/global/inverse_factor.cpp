#include "csrbf/approx/global/inverse_factor.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <numeric>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index grain = 64;               // samples per task
constexpr Index coarse_per_column = 4;    // of the first samples, per polynomial: they make G well conditioned
constexpr double regularization = 1e-13;  // of the polynomial's part, where neighbours do not determine it
constexpr double least_variance = 1e-15;  // d_i in units of the largest |K| between the samples of c_i

// The `count` points nearest to each point of rank >= `begin` among those of lower rank, as ranks; -1 where there are
// fewer. Points are ordered by rank.
template <int Dim>
Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic> nearest_before(const Points<Dim>& points, Index count) {
  const Index n = points.cols();
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic> nearest(count, n);
  nearest.setConstant(-1);
  for (Index lo = 1; lo < n; lo = std::min(n, 2 * lo)) {
    const Index hi = std::min(n, 2 * lo);
    const std::vector<Index> order = morton_order<Dim>(points.leftCols(hi));
    const Points<Dim> sorted = points(Eigen::all, order);
    const KdTree<Dim> tree(sorted);
    const Index asked = std::min(hi, 2 * count + 2);
    parallel_for(hi, grain, [&](Index first, Index last) {
      std::vector<Index> found(asked);
      std::vector<double> r2(asked);
      for (Index k = first; k < last; ++k) {
        const Index i = order[k];
        if (i < lo) continue;
        const Index got = tree.nearest(sorted.col(k), asked, found.data(), r2.data());
        Index kept = 0;
        for (Index f = 0; f < got && kept < count; ++f)
          if (order[found[f]] < i) nearest(kept++, i) = static_cast<std::int32_t>(order[found[f]]);
      }
    });
  }
  return nearest;
}

template <int Dim>
Eigen::MatrixXd kernel_matrix(const Kernel& kernel, double support, const Points<Dim>& x) {
  const Index n = x.cols();
  Eigen::MatrixXd r2(n, n), K(n, n);
  for (Index j = 0; j < n; ++j)
    r2.col(j) = (x.colwise() - x.col(j)).colwise().squaredNorm().transpose() / (support * support);
  kernel.values(r2.data(), n * n, K.data());
  return K;
}

}  // namespace

template <int Dim>
InverseFactor::InverseFactor(const PointsRef<Dim>& points, const Kernel& kernel, double support,
                             const Eigen::VectorXd& noise, const Eigen::MatrixXd& G, Index neighbors,
                             const Progress& progress) {
  const Index n = points.cols(), q = G.cols();
  const std::vector<Index> order = farthest_points<Dim>(points, n).indices;
  const Points<Dim> x = points(Eigen::all, order);
  const auto nearest = nearest_before<Dim>(x, neighbors);
  const Index coarse = coarse_per_column * q;

  // Row i: the samples of c_i, as ranks, itself last.
  const Index width = neighbors + coarse + 1;
  begin_.assign(n + 1, 0);
  const auto samples_of = [&](Index i, std::vector<std::int32_t>& set) {
    set.clear();
    if (i < q) return;
    for (Index k = 0; k < std::min(i, coarse); ++k) set.push_back(static_cast<std::int32_t>(k));
    for (Index k = 0; k < neighbors && nearest(k, i) >= 0; ++k)
      if (nearest(k, i) >= coarse) set.push_back(nearest(k, i));
    set.push_back(static_cast<std::int32_t>(i));
  };
  std::vector<std::int32_t> counted;
  counted.reserve(width);
  for (Index i = 0; i < n; ++i) {
    samples_of(i, counted);
    begin_[i + 1] = begin_[i] + std::ssize(counted);
  }
  Eigen::VectorXd variances = Eigen::VectorXd::Ones(n);
  const double extent = bounding_box<Dim>(points).diagonal() / support;
  const double largest = std::max(std::abs(kernel.value(0)), std::abs(kernel.value(extent)));
  sample_.resize(begin_[n]);
  entry_.resize(begin_[n]);
  parallel_for(n, grain, [&](Index first, Index last) {
    std::vector<std::int32_t> set;
    for (Index i = first; i < last; ++i) {
      samples_of(i, set);
      if (set.empty()) continue;
      const Index m = std::ssize(set) - 1;
      Points<Dim> some(Dim, m + 1);
      for (Index k = 0; k <= m; ++k) some.col(k) = x.col(set[k]);
      Eigen::MatrixXd K = kernel_matrix<Dim>(kernel, support, some);
      const double scale = std::max(K.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
      K /= scale;
      for (Index k = 0; k <= m; ++k) K(k, k) += noise[noise.size() == 1 ? 0 : order[set[k]]] / scale;
      Eigen::MatrixXd system = Eigen::MatrixXd::Zero(m + q, m + q);
      Eigen::VectorXd right(m + q);
      system.topLeftCorner(m, m) = K.topLeftCorner(m, m);
      right.head(m) = K.col(m).head(m);
      const double column = std::sqrt(static_cast<double>(n));  // G has columns of unit norm
      for (Index k = 0; k < m; ++k) system.block(k, m, 1, q) = column * G.row(order[set[k]]);
      system.bottomLeftCorner(q, m) = system.topRightCorner(m, q).transpose();
      system.bottomRightCorner(q, q).diagonal().setConstant(-regularization);
      right.tail(q) = column * G.row(order[i]).transpose();
      Eigen::VectorXd c(m + 1);
      c.head(m) = -system.partialPivLu().solve(right).head(m);
      c[m] = 1;
      const double d = scale * std::max(c.dot(K * c), least_variance * c.squaredNorm());
      variances[i] = d / largest;
      const double factor = 1 / std::sqrt(d);
      for (Index k = 0; k <= m; ++k) {
        sample_[begin_[i] + k] = static_cast<std::int32_t>(order[set[k]]);
        entry_[begin_[i] + k] = factor * c[k];
      }
    }
  });
  smallest_variance_ = variances.minCoeff();
  report(progress, "factor", 1);
}

Eigen::VectorXd InverseFactor::apply(const Eigen::VectorXd& r) const {
  const Index n = std::ssize(begin_) - 1;
  Eigen::VectorXd t(n);
  parallel_for(n, 4096, [&](Index first, Index last) {
    for (Index i = first; i < last; ++i) {
      double sum = 0;
      for (Index e = begin_[i]; e < begin_[i + 1]; ++e) sum += entry_[e] * r[sample_[e]];
      t[i] = sum;
    }
  });
  Eigen::VectorXd z = Eigen::VectorXd::Zero(n);
  for (Index i = 0; i < n; ++i)
    for (Index e = begin_[i]; e < begin_[i + 1]; ++e) z[sample_[e]] += entry_[e] * t[i];
  return z;
}

Eigen::VectorXd InverseFactor::diagonal() const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(std::ssize(begin_) - 1);
  for (std::size_t e = 0; e < entry_.size(); ++e) sum[sample_[e]] += entry_[e] * entry_[e];
  return sum;
}

#define CSRBF_INSTANTIATE(Dim)                                                                                \
  template InverseFactor::InverseFactor(const PointsRef<Dim>&, const Kernel&, double, const Eigen::VectorXd&, \
                                        const Eigen::MatrixXd&, Index, const Progress&);
CSRBF_INSTANTIATE(1) CSRBF_INSTANTIATE(2) CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
