#include "csrbf/approx/global/inverse_factor.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <algorithm>
#include <numeric>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index grain = 64;             // samples per task
constexpr Index most_coarse = 1000;     // samples that see all before them, at most ...
constexpr Index coarse_share = 20;      // ... and one in so many
constexpr Index spread_per_column = 4;  // first samples, per polynomial, from which all are predicted
constexpr double first_jitter = 1e-15;  // of the largest entry, where rounding makes a system indefinite
constexpr double jitter_step = 100;
constexpr double common_share = .05;  // of the samples have a variance below the common one

// The `count` points nearest to each point of rank >= `begin` among those of lower rank, as ranks; -1 where there are
// fewer. Points are ordered by rank.
template <int Dim>
InverseFactor::Ranks nearest_before(const Points<Dim>& points, Index count) {
  const Index n = points.cols();
  InverseFactor::Ranks nearest(count, n);
  nearest.setConstant(-1);
  for (Index lo = 1; lo < n; lo = std::min(n, 2 * lo)) {
    const Index hi = std::min(n, 2 * lo);
    const std::vector<Index> order = morton_order<Dim>(points.leftCols(hi));
    const Points<Dim> sorted = chosen_points<Dim>(points, order);
    const KdTree<Dim> tree(sorted);
    parallel_for(hi, grain, [&](Index first, Index last) {
      std::vector<Index> found;
      std::vector<double> r2;
      for (Index k = first; k < last; ++k) {
        const Index i = order[k];
        if (i < lo) continue;
        // About half of the nearest come before; in a cluster that fills up at this level fewer.
        Index kept = 0;
        for (Index asked = 2 * count + 2; 2 * kept < std::min(count, i); asked *= 4) {
          found.resize(std::min(hi, asked));
          r2.resize(found.size());
          const Index got = tree.nearest(sorted.col(k), std::ssize(found), found.data(), r2.data());
          kept = 0;
          for (Index f = 0; f < got && kept < count; ++f)
            if (order[found[f]] < i) nearest(kept++, i) = static_cast<std::int32_t>(order[found[f]]);
        }
      }
    });
  }
  return nearest;
}

Eigen::MatrixXd kernel_matrix(const Kernel& kernel, double support, const Eigen::MatrixXd& x) {
  const Index n = x.cols();
  Eigen::MatrixXd r2(n, n), K(n, n);
  for (Index j = 0; j < n; ++j) squared_distances(x, 0, x.col(j).data(), r2.col(j).data());
  r2 /= support * support;
  kernel.values(r2.data(), n * n, K.data());
  return K;
}

// Errors of predictions of samples from those before them, with weights that vanish on polynomials: q of the samples,
// `fixed`, carry these. K and G are those of all samples.
struct Predictions {
  std::vector<Index> fixed;
  std::vector<Index> others;  // in order
  Eigen::MatrixXd lambda;     // the values of the others by polynomials through the fixed ones
  Eigen::MatrixXd L;          // Cholesky factor of the covariance of the others minus these

  // Among all but the last.
  void choose_fixed(const Eigen::MatrixXd& G) {
    const Index m = G.rows() - 1, q = G.cols();
    fixed.clear();
    others.resize(m + 1);
    std::iota(others.begin(), others.end(), Index{0});
    lambda.resize(m + 1 - q, q);
    if (q == 0) return;
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(Eigen::MatrixXd(G.topRows(m).transpose()));
    const auto& order = qr.colsPermutation().indices();
    fixed.assign(order.data(), order.data() + q);
    std::sort(fixed.begin(), fixed.end());
    std::erase_if(others, [&](Index k) { return std::binary_search(fixed.begin(), fixed.end(), k); });
    const Eigen::MatrixXd at_fixed = G(fixed, Eigen::all).transpose();
    lambda = solve_by_lu(at_fixed, Eigen::MatrixXd(G(others, Eigen::all).transpose())).transpose();
  }

  void factorize(const Eigen::MatrixXd& K) {
    Eigen::MatrixXd of_others = K(others, others);
    if (!fixed.empty()) {
      const Eigen::MatrixXd to_fixed = K(others, fixed);
      Eigen::MatrixXd half = -to_fixed;
      half.noalias() += .5 * lambda * K(fixed, fixed);
      of_others.noalias() += lambda * half.transpose();
      of_others.noalias() += half * lambda.transpose();
    }
    const double largest = of_others.diagonal().cwiseAbs().maxCoeff();
    Eigen::LLT<Eigen::MatrixXd> cholesky(of_others);
    for (double jitter = first_jitter; cholesky.info() != Eigen::Success && jitter < 1; jitter *= jitter_step) {
      of_others.diagonal().array() += jitter * std::max(largest, std::numeric_limits<double>::min());
      cholesky.compute(of_others);
    }
    L = cholesky.matrixL();
  }
};

}  // namespace

template <int Dim>
InverseFactor::InverseFactor(const PointsRef<Dim>& points, const Kernel& kernel, double support,
                             const Eigen::VectorXd& noise, const Eigen::MatrixXd& G, Index neighbors,
                             const Progress& progress) {
  const Index n = points.cols(), q = G.cols();
  std::vector<Index> order = farthest_points<Dim>(points, n).indices;
  if (q > 0) {  // first those that determine the polynomials best
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(Eigen::MatrixXd(G(order, Eigen::all).transpose()));
    std::vector<Index> first(qr.colsPermutation().indices().data(), qr.colsPermutation().indices().data() + q);
    std::sort(first.begin(), first.end());
    for (Index k = 0; k < q; ++k)
      std::rotate(order.begin() + k, order.begin() + first[k], order.begin() + first[k] + 1);
  }
  const Points<Dim> x = chosen_points<Dim>(points, order);
  build(order, x, nearest_before<Dim>(x, neighbors), kernel, support, noise, G);
  report(progress, "factor", 1);
}

void InverseFactor::build(const std::vector<Index>& order, const Eigen::MatrixXd& x, const Ranks& nearest,
                          const Kernel& kernel, double support, const Eigen::VectorXd& noise,
                          const Eigen::MatrixXd& G) {
  const Index n = x.cols(), q = G.cols(), neighbors = nearest.rows();
  const Eigen::MatrixXd polynomials = std::sqrt(static_cast<double>(n)) * G(order, Eigen::all);
  const Index coarse =
      std::min(n, std::max(neighbors + spread_per_column * q, std::min(n / coarse_share, most_coarse)));
  const Index spread = spread_per_column * q;

  const auto add_noise = [&](const std::vector<Index>& ranks, Eigen::MatrixXd& K) {
    for (Index k = 0; k < std::ssize(ranks); ++k) K(k, k) += noise[noise.size() == 1 ? 0 : order[ranks[k]]];
  };
  // The samples that i is predicted from, as ranks, and itself. A few spread over all help where the nearest ones lie
  // on a track.
  const auto samples_of = [&](Index i, std::vector<Index>& set) {
    set.clear();
    for (Index k = 0; k < spread; ++k) set.push_back(k);
    for (Index k = 0; k < neighbors && nearest(k, i) >= 0; ++k)
      if (nearest(k, i) >= spread) set.push_back(nearest(k, i));
    set.push_back(i);
  };
  begin_.assign(n + 1, 0);
  std::vector<Index> counted;
  for (Index i = 0; i < n; ++i) {
    if (i >= coarse) samples_of(i, counted);
    begin_[i + 1] = begin_[i] + (i < q ? 0 : i < coarse ? i + 1 : std::ssize(counted));
  }
  sample_.resize(begin_[n]);
  entry_.resize(begin_[n]);
  Eigen::VectorXd variances(n);

  // Row i of the result from row `row` of the inverse of L, over the ranks `set`.
  const auto store = [&](Index i, const std::vector<Index>& set, const Predictions& predictions,
                         const Eigen::VectorXd& row) {
    Index at = begin_[i];
    const auto put = [&](Index place, double entry) {
      sample_[at] = static_cast<std::int32_t>(order[set[place]]);
      entry_[at++] = entry;
    };
    const Eigen::VectorXd fixed = -(predictions.lambda.topRows(row.size()).transpose() * row);
    for (Index k = 0; k < std::ssize(predictions.fixed); ++k) put(predictions.fixed[k], fixed[k]);
    for (Index k = 0; k < row.size(); ++k) put(predictions.others[k], row[k]);
    variances[i] = 1 / (row[row.size() - 1] * row[row.size() - 1]);
  };

  if (coarse > q) {
    std::vector<Index> set(coarse);
    std::iota(set.begin(), set.end(), Index{0});
    Eigen::MatrixXd K = kernel_matrix(kernel, support, x.leftCols(coarse));
    add_noise(set, K);
    Predictions predictions;
    predictions.others.assign(set.begin() + q, set.end());
    predictions.fixed.assign(set.begin(), set.begin() + q);
    predictions.lambda = Eigen::MatrixXd(coarse - q, q);
    if (q > 0)
      predictions.lambda = solve_by_lu(polynomials.topRows(q).transpose(),
                                       Eigen::MatrixXd(polynomials.middleRows(q, coarse - q).transpose()))
                               .transpose();
    predictions.factorize(K);
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(coarse - q, coarse - q);
    predictions.L.triangularView<Eigen::Lower>().solveInPlace(inverse);
    for (Index i = q; i < coarse; ++i) store(i, set, predictions, inverse.row(i - q).head(i - q + 1).transpose());
  }
  parallel_for(n - coarse, grain, [&](Index first, Index last) {
    std::vector<Index> set;
    Predictions predictions;
    for (Index i = coarse + first; i < coarse + last; ++i) {
      samples_of(i, set);
      predictions.choose_fixed(polynomials(set, Eigen::all));
      Eigen::MatrixXd K = kernel_matrix(kernel, support, x(Eigen::all, set));
      add_noise(set, K);
      predictions.factorize(K);
      Eigen::VectorXd row = Eigen::VectorXd::Unit(predictions.L.rows(), predictions.L.rows() - 1);
      predictions.L.triangularView<Eigen::Lower>().transpose().solveInPlace(row);
      store(i, set, predictions, row);
    }
  });
  const double extent = (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm() / support;
  const double largest = std::max(std::abs(kernel.value(0)), std::abs(kernel.value(extent)));
  if (n > q) {
    std::vector<double> sorted(variances.data() + q, variances.data() + n);
    const auto place = static_cast<std::ptrdiff_t>(common_share * static_cast<double>(sorted.size()));
    std::nth_element(sorted.begin(), sorted.begin() + place, sorted.end());
    common_variance_ = sorted[place] / largest;
  }
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
