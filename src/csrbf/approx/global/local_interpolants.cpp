#include "csrbf/approx/global/local_interpolants.hpp"

#include "csrbf/core/lanes.hpp"
#include "csrbf/linalg/batched_saddle.hpp"

#include <numeric>

namespace csrbf {
namespace {

using MatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

// Unknowns; batches of larger systems exceed the caches, so that solving one at a time is faster.
constexpr Index largest_batched = 192;

std::size_t doubles(Index blocks) {
  return static_cast<std::size_t>(batch_lanes * blocks);
}

// The queries of a call by their neighbours: `order` sorts them so that those with the same neighbours are consecutive.
struct Neighborhoods {
  struct Group {
    Index begin;
    Index end;
  };
  Index k;
  std::vector<Index> lists;  // ascending, k for each query
  std::vector<Index> order;
  std::vector<Group> groups;  // larger ones first

  [[nodiscard]] const Index* list(Index query) const { return lists.data() + k * query; }
  [[nodiscard]] const Index* neighbors(const Group& g) const { return list(order[g.begin]); }
  // Query number i of a group, the last one again beyond its end.
  [[nodiscard]] Index query(const Group& g, Index i) const { return order[std::min(g.begin + i, g.end - 1)]; }
};

Neighborhoods find_neighborhoods(const LocalInterpolants& samples, const MatrixRef& x) {
  const Index m = x.cols();
  Neighborhoods found{samples.neighbors, {}, {}, {}};
  const Index k = found.k;
  found.lists.resize(k * m);
  std::vector<double> squared_distances(k);
  for (Index i = 0; i < m; ++i) {
    Index* list = found.lists.data() + k * i;
    samples.search.nearest(x.col(i).data(), k, list, squared_distances.data());
    std::sort(list, list + k);
  }
  found.order.resize(m);
  std::iota(found.order.begin(), found.order.end(), Index{0});
  std::sort(found.order.begin(), found.order.end(), [&](Index a, Index b) {
    const auto [in_a, in_b] = std::mismatch(found.list(a), found.list(a) + k, found.list(b));
    return in_a == found.list(a) + k ? a < b : *in_a < *in_b;
  });
  for (Index begin = 0; begin < m;) {
    const Index* list = found.list(found.order[begin]);
    Index end = begin + 1;
    while (end < m && std::equal(list, list + k, found.list(found.order[end]))) ++end;
    found.groups.push_back({begin, end});
    begin = end;
  }
  std::stable_sort(found.groups.begin(), found.groups.end(),
                   [](const auto& a, const auto& b) { return a.end - a.begin > b.end - b.begin; });
  return found;
}

// The polynomials' coordinates of n points of d coordinates, entry (a, i) of lane l at y[8 (d i + a) + l].
CSRBF_ALWAYS_INLINE void to_frame(const double* y, Index d, Index n, const double* shift, const double* scale,
                                  double* u) {
  for (Index i = 0; i < n; ++i)
    for (Index a = 0; a < batch_lanes * d; ++a)
      u[batch_lanes * d * i + a] = (y[batch_lanes * d * i + a] - shift[a]) / scale[a];
}

CSRBF_ALWAYS_INLINE void find_frame(const double* y, Index d, Index n, double* shift, double* scale) {
  std::copy_n(y, batch_lanes * d, shift);
  std::copy_n(y, batch_lanes * d, scale);
  for (Index i = 1; i < n; ++i)
    for (Index a = 0; a < batch_lanes * d; ++a) {
      const double at = y[batch_lanes * d * i + a];
      shift[a] = at < shift[a] ? at : shift[a];
      scale[a] = at > scale[a] ? at : scale[a];
    }
  for (Index a = 0; a < batch_lanes * d; ++a) {
    const double half = .5 * scale[a] - .5 * shift[a];
    shift[a] = .5 * shift[a] + .5 * scale[a];
    scale[a] = half > 0 ? half : 1;
  }
}

// Monomials at n points, entry (i, q) at G[8 (q n + i) + l].
CSRBF_ALWAYS_INLINE void monomials(const double* u, Index d, Index n, const std::int16_t* parent,
                                   const std::int16_t* axis, Index Q, double* G) {
  if (Q > 0) std::fill_n(G, batch_lanes * n, 1.0);
  for (Index q = 1; q < Q; ++q) {
    const double* from = G + batch_lanes * n * parent[q];
    double* to = G + batch_lanes * n * q;
    for (Index i = 0; i < n; ++i)
      (Doubles(from + batch_lanes * i) * Doubles(u + batch_lanes * (d * i + axis[q]))).store(to + batch_lanes * i);
  }
}

CSRBF_ALWAYS_INLINE void pair_distances(const double* y, Index d, Index n, double epsilon2, double* r2) {
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j <= i; ++j, r2 += batch_lanes)
      store_squared_distance(y + batch_lanes * d * i, y + batch_lanes * d * j, d, epsilon2, r2);
}

CSRBF_ALWAYS_INLINE void query_distances(const double* x, const double* y, Index d, Index n, double epsilon2,
                                         double* r2) {
  for (Index i = 0; i < n; ++i) store_squared_distance(x, y + batch_lanes * d * i, d, epsilon2, r2 + batch_lanes * i);
}

CSRBF_ALWAYS_INLINE void add_products(const double* a, const double* b, Index n, double* sum) {
  Doubles part(sum);
  for (Index i = 0; i < batch_lanes * n; i += batch_lanes) part += Doubles(a + i) * Doubles(b + i);
  part.store(sum);
}

// Eight local systems at a time.
class Batch {
 public:
  Batch(const LocalInterpolants& samples, const Neighborhoods& found)
      : samples_(samples),
        found_(found),
        basis_(samples.basis),
        d_(samples.points.rows()),
        n_(samples.neighbors),
        Q_(basis_.monomials.size()),
        k_(samples.values.rows()),
        y_(doubles(d_ * n_)),
        u_(y_.size()),
        shift_(doubles(d_)),
        scale_(doubles(d_)),
        r2_(static_cast<std::size_t>(batch_matrix_size(n_))),
        A_(r2_.size()),
        G_(doubles(Q_ * n_)),
        s_(doubles(k_ * n_)),
        pi_(doubles(k_ * Q_)),
        work_(static_cast<std::size_t>(batch_saddle_work(n_))) {}

  // Solves groups first, ..., first + 7 (the last one again beyond the end). Returns the lanes that failed.
  BatchMask solve(std::size_t first) {
    gather(first);
    simd<find_frame>(y_.data(), d_, n_, shift_.data(), scale_.data());
    simd<to_frame>(y_.data(), d_, n_, shift_.data(), scale_.data(), u_.data());
    simd<monomials>(u_.data(), d_, n_, basis_.monomials.parent.data(), basis_.monomials.axis.data(), Q_, G_.data());
    simd<pair_distances>(y_.data(), d_, n_, basis_.epsilon2, r2_.data());
    basis_.kernel.values(r2_.data(), batch_matrix_size(n_), A_.data());
    for (int l = 0; l < batch_lanes; ++l) {
      const Index* list = found_.neighbors(group(first, l));
      for (Index i = 0; i < n_; ++i) A_[batch_entry(i, i) + l] += samples_.smoothing[list[i]];
    }
    return batch_saddle({n_, Q_, k_, A_.data(), G_.data(), s_.data(), pi_.data(), work_.data()});
  }

  // Query number i of each group.
  void evaluate(std::size_t first, Index i, const MatrixRef& x, Eigen::Ref<Eigen::MatrixXd> out) {
    for (int l = 0; l < batch_lanes; ++l)
      for (Index a = 0; a < d_; ++a) y_query_[batch_lanes * a + l] = x(a, found_.query(group(first, l), i));
    simd<query_distances>(y_query_.data(), y_.data(), d_, n_, basis_.epsilon2, r2_.data());
    basis_.kernel.values(r2_.data(), batch_lanes * n_, A_.data());
    simd<to_frame>(y_query_.data(), d_, 1, shift_.data(), scale_.data(), u_.data());
    simd<monomials>(u_.data(), d_, 1, basis_.monomials.parent.data(), basis_.monomials.axis.data(), Q_, G_.data());
    for (Index c = 0; c < k_; ++c) {
      double sum[batch_lanes] = {};
      simd<add_products>(A_.data(), s_.data() + batch_lanes * c * n_, n_, sum);
      simd<add_products>(G_.data(), pi_.data() + batch_lanes * c * Q_, Q_, sum);
      for (int l = 0; l < batch_lanes; ++l) out(c, found_.query(group(first, l), i)) = sum[l];
    }
  }

 private:
  [[nodiscard]] const Neighborhoods::Group& group(std::size_t first, int lane) const {
    return found_.groups[std::min(first + static_cast<std::size_t>(lane), found_.groups.size() - 1)];
  }

  void gather(std::size_t first) {
    for (int l = 0; l < batch_lanes; ++l) {
      const Index* list = found_.neighbors(group(first, l));
      for (Index i = 0; i < n_; ++i) {
        for (Index a = 0; a < d_; ++a) y_[batch_lanes * (d_ * i + a) + l] = samples_.points(a, list[i]);
        for (Index c = 0; c < k_; ++c) s_[batch_lanes * (c * n_ + i) + l] = samples_.values(c, list[i]);
      }
    }
  }

  const LocalInterpolants& samples_;
  const Neighborhoods& found_;
  const RbfBasis& basis_;
  Index d_, n_, Q_, k_;
  std::vector<double> y_, u_, shift_, scale_, r2_, A_, G_, s_, pi_, work_;
  std::vector<double> y_query_ = std::vector<double>(doubles(d_));
};

// A single system.
void solve_alone(const LocalInterpolants& samples, const Neighborhoods& found, const Neighborhoods::Group& group,
                 const MatrixRef& x, Eigen::Ref<Eigen::MatrixXd> out) {
  const Index* begin = found.neighbors(group);
  const std::vector<Index> list(begin, begin + found.k);
  const Eigen::MatrixXd y = samples.points(Eigen::all, list);
  const RbfCoefficients f = samples.basis.solve(y, samples.values(Eigen::all, list), samples.smoothing(list));
  for (Index i = group.begin; i < group.end; ++i) {
    const Index query = found.order[i];
    samples.basis.evaluate(y, f, x.col(query), out.col(query));
  }
}

}  // namespace

void LocalInterpolants::evaluate(const MatrixRef& x, Eigen::Ref<Eigen::MatrixXd> out) const {
  const Neighborhoods found = find_neighborhoods(*this, x);
  if (neighbors > largest_batched) {
    for (const auto& group : found.groups) solve_alone(*this, found, group, x, out);
    return;
  }
  Batch batch(*this, found);
  for (std::size_t first = 0; first < found.groups.size(); first += batch_lanes) {
    const BatchMask failed = batch.solve(first);
    const Index rounds = found.groups[first].end - found.groups[first].begin;
    for (Index i = 0; i < rounds; ++i) batch.evaluate(first, i, x, out);
    for (int l = 0; l < batch_lanes; ++l) {
      const std::size_t of_lane = first + static_cast<std::size_t>(l);
      if ((failed >> l & 1U) != 0 && of_lane < found.groups.size())
        solve_alone(*this, found, found.groups[of_lane], x, out);
    }
  }
}

}  // namespace csrbf
