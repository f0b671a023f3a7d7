#include "csrbf/approx/unity/local_fit.hpp"

#include "csrbf/approx/unity/patch_samples.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/lanes.hpp"

namespace csrbf {
namespace {

constexpr int L = batch_lanes;
constexpr double dependent = 1e-11;  // relative pivots below mark dependent columns, as in solve_saddle()
constexpr double round_off = 1e-14;  // relative ridge that keeps systems positive definite, some ten roundings
// Least value of 1 - leverage of a sample left out, which its error is divided by: bounds the error where the other
// samples do not determine the fit. Chosen by hand.
constexpr double smallest_freedom = 1e-6;

// Squared distances of all pairs of n points, lower triangle by rows.
CSRBF_ALWAYS_INLINE void pair_distances(const double* q, int dim, Index n, double scale, double* r2) {
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j <= i; ++j, r2 += L) store_squared_distance(q + L * dim * i, q + L * dim * j, dim, scale, r2);
}

// r2[n j + i] of all points to the chosen ones.
CSRBF_ALWAYS_INLINE void distances_to(const double* q, int dim, Index n, const Index* chosen, Index m, double scale,
                                      double* r2) {
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < m; ++j, r2 += L)
      store_squared_distance(q + L * dim * i, q + L * dim * chosen[j], dim, scale, r2);
}

// out = a b, lane by lane.
CSRBF_ALWAYS_INLINE void multiply(const double* a, const double* b, double* out) {
  (Doubles(a) * Doubles(b)).store(out);
}

// y -= F b for the first `columns` entries of each of n rows of `width` entries.
CSRBF_ALWAYS_INLINE void subtract_product(const double* F, Index n, Index width, Index columns, const double* b,
                                          double* y) {
  for (Index k = 0; k < n; ++k) {
    Doubles sum(0.0);
    for (Index j = 0; j < columns; ++j) sum += Doubles(F + L * (width * k + j)) * Doubles(b + L * j);
    (Doubles(y + L * k) - sum).store(y + L * k);
  }
}

// sum_k a_k b_k, lane by lane.
CSRBF_ALWAYS_INLINE void dot(const double* a, const double* b, Index n, double* sum) {
  Doubles s(0.0);
  for (Index k = 0; k < n; ++k) s += Doubles(a + L * k) * Doubles(b + L * k);
  s.store(sum);
}

// Adds to every diagonal entry a share of the mean of the first n.
void add_ridge(double* A, Index n, double share) {
  double trace[L] = {};
  for (Index i = 0; i < n; ++i)
    for (int l = 0; l < L; ++l) trace[l] += A[batch_entry(i, i) + l];
  for (Index i = 0; i < n; ++i)
    for (int l = 0; l < L; ++l) A[batch_entry(i, i) + l] += share * trace[l] / static_cast<double>(n);
}

}  // namespace

template <int Dim>
LocalFitter<Dim>::LocalFitter(const Cover<Dim>& cover, const Eigen::MatrixXd& values, const Eigen::VectorXd& weights,
                              const LocalOptions& options)
    : cover_(cover),
      values_(values),
      weights_(weights),
      options_(options),
      kernel_(options.kernel, Dim),
      basis_(options.degree),
      n_(std::min(options.samples, cover.points().cols())),
      M_(std::min(options.centers, n_)),
      Q_(basis_.size()),
      C_(values.cols()),
      anisotropic_(options.anisotropy > 0 && M_ > 0),
      inverse_support2_(1 / (options.support * options.support)) {
  require(options.samples >= 1, "LocalFitter", "samples", options.samples, "must be at least 1");
  for (Index j = 0; j < M_; ++j) center_rows_.push_back(j * n_ / M_);
  const auto n = static_cast<std::size_t>(n_), M = static_cast<std::size_t>(M_), Q = static_cast<std::size_t>(Q_),
             C = static_cast<std::size_t>(C_);
  const std::size_t width = interpolates() ? Q + C : Q + M + C;
  q_.resize(L * n * Dim);
  s_.resize(L * n * C);
  weight_.resize(L * n);
  F_.resize(L * n * width);
  G_.resize(batch_matrix_size(static_cast<Index>(width)));
  const std::size_t pairs = interpolates() ? static_cast<std::size_t>(batch_matrix_size(n_)) : L * n * M;
  r2_.resize(pairs);
  A_.resize(pairs);
}

template <int Dim>
LocalModels<Dim> LocalFitter<Dim>::models() const {
  LocalModels<Dim> models;
  models.degree = options_.degree;
  models.kernel = kernel_;
  models.support = options_.support;
  models.centers_each = M_;
  models.components = C_;
  models.anisotropic = anisotropic_;
  return models;
}

// The samples in local coordinates; unused lanes repeat the first one.
template <int Dim>
void LocalFitter<Dim>::gather(const Index* cells, int count, LocalModels<Dim>& models, Index first,
                              FoundSamples<Dim>* const* known) {
  for (int l = 0; l < L; ++l) {
    const int used = l < count ? l : 0;
    const Box<Dim>& cell = cover_.cell(cells[used]);
    const Point<Dim> center = cell.center();
    FoundSamples<Dim>& patch = known != nullptr ? *known[used] : patch_;
    if (known == nullptr || patch.found.empty()) {
      patch.metric = find_patch_samples(cover_, cells[used], n_, anisotropic_ ? options_.anisotropy : 0, search_);
      patch.found = search_.found;
    }
    Eigen::Matrix<double, Dim, Dim> metric = patch.metric;
    double radius = std::sqrt(patch.found.back().first);
    if (!(radius > 0)) radius = cell.diagonal();
    if (anisotropic_) {
      double farthest2 = 0;
      for (const auto& [d2, id] : patch.found)
        farthest2 = std::max(farthest2, (metric * (cover_.points().col(id) - center)).squaredNorm());
      if (farthest2 > 0) metric *= radius / std::sqrt(farthest2);
      if (l < count) std::copy_n(metric.data(), Dim * Dim, models.metric.data() + Dim * Dim * (first + l));
    }
    if (l < count) {
      models.center.col(first + l) = center;
      models.radius[first + l] = radius;
    }
    for (Index k = 0; k < n_; ++k) {
      const std::uint32_t id = patch.found[k].second;
      Point<Dim> q = (cover_.points().col(id) - center) / radius;
      if (anisotropic_) q = metric * q;
      for (int a = 0; a < Dim; ++a) q_[L * (Dim * k + a) + l] = q[a];
      for (Index c = 0; c < C_; ++c) s_[L * (n_ * c + k) + l] = values_(id, c);
      weight_[L * k + l] = weights_.size() == 0 ? 1 : std::sqrt(weights_[id]);
    }
  }
}

// Weighted monomials: the first Q of `width` entries of each row of F.
template <int Dim>
void LocalFitter<Dim>::polynomial_rows(Index width) {
  for (Index k = 0; k < n_; ++k) {
    double* row = F_.data() + L * width * k;
    for (Index j = 0; j < Q_; ++j) {
      if (j == 0) {
        std::copy_n(weight_.data() + L * k, L, row);
      } else {
        const auto& step = basis_.steps()[j];
        simd<multiply>(row + L * step.parent, q_.data() + L * (Dim * k + step.axis), row + L * j);
      }
    }
  }
}

template <int Dim>
void LocalFitter<Dim>::fit(const Index* cells, int count, LocalModels<Dim>& models, Index first,
                           FoundSamples<Dim>* const* known) {
  gather(cells, count, models, first, known);
  if (interpolates())
    fit_interpolant(models, first, count);
  else
    fit_least_squares(models, first, count);
  for (int l = 0; l < count; ++l)
    for (Index j = 0; j < M_; ++j)
      for (int a = 0; a < Dim; ++a)
        models.position[Dim * (M_ * (first + l) + j) + a] =
            q_[L * (Dim * center_rows_[static_cast<std::size_t>(j)] + a) + l];
}

template <int Dim>
void LocalFitter<Dim>::fit_interpolant(LocalModels<Dim>& models, Index first, int count) {
  // Least squares polynomial c of the values; its residual.
  const Index width = Q_ + C_;
  if (Q_ > 0) {
    polynomial_rows(width);
    for (Index k = 0; k < n_; ++k)
      for (Index c = 0; c < C_; ++c)
        simd<multiply>(s_.data() + L * (n_ * c + k), weight_.data() + L * k, F_.data() + L * (width * k + Q_ + c));
    std::fill(G_.begin(), G_.end(), 0.0);
    batch_gram(F_.data(), n_, width, G_.data());
    add_ridge(G_.data(), Q_, round_off);
    batch_cholesky(G_.data(), Q_, dependent);
    for (Index k = 0; k < n_; ++k)  // the unweighted monomials
      for (Index j = 0; j < Q_; ++j)
        for (int l = 0; l < L; ++l) F_[L * (width * k + j) + l] /= weight_[L * k + l];
    for (Index c = 0; c < C_; ++c) {
      double* b = G_.data() + batch_entry(Q_ + c, 0);
      batch_solve(G_.data(), Q_, b);
      simd<subtract_product>(F_.data(), n_, width, Q_, b, s_.data() + L * n_ * c);
      for (int l = 0; l < count; ++l)
        for (Index j = 0; j < Q_; ++j) models.polynomial[Q_ * (C_ * (first + l) + c) + j] = b[L * j + l];
    }
  }
  // (A + lambda W^-1) alpha = residual.
  simd<pair_distances>(q_.data(), Dim, n_, inverse_support2_, r2_.data());
  kernel_.values(r2_.data(), static_cast<Index>(r2_.size()), A_.data());
  for (Index k = 0; k < n_; ++k)
    for (int l = 0; l < L; ++l) {
      const double w = weight_[L * k + l];
      A_[batch_entry(k, k) + l] += options_.smoothing / (w * w) + round_off * static_cast<double>(n_);
    }
  batch_cholesky(A_.data(), n_, round_off);
  batch_solve(A_.data(), n_, s_.data(), C_);
  for (int l = 0; l < count; ++l)
    for (Index c = 0; c < C_; ++c)
      for (Index j = 0; j < n_; ++j) models.alpha[n_ * (C_ * (first + l) + c) + j] = s_[L * (n_ * c + j) + l];
}

template <int Dim>
void LocalFitter<Dim>::fit_least_squares(LocalModels<Dim>& models, Index first, int count) {
  const Index width = Q_ + M_ + C_, unknowns = Q_ + M_;
  polynomial_rows(width);
  simd<distances_to>(q_.data(), Dim, n_, center_rows_.data(), M_, inverse_support2_, r2_.data());
  kernel_.values(r2_.data(), static_cast<Index>(r2_.size()), A_.data());
  for (Index k = 0; k < n_; ++k) {
    double* row = F_.data() + L * width * k;
    const double* w = weight_.data() + L * k;
    for (Index j = 0; j < M_; ++j) simd<multiply>(A_.data() + L * (M_ * k + j), w, row + L * (Q_ + j));
    for (Index c = 0; c < C_; ++c) simd<multiply>(s_.data() + L * (n_ * c + k), w, row + L * (unknowns + c));
  }
  std::fill(G_.begin(), G_.end(), 0.0);
  batch_gram(F_.data(), n_, width, G_.data());
  for (Index i = 0; i < M_; ++i)
    for (Index j = 0; j <= i; ++j)
      for (int l = 0; l < L; ++l)
        G_[batch_entry(Q_ + i, Q_ + j) + l] +=
            options_.smoothing * A_[L * (M_ * center_rows_[static_cast<std::size_t>(i)] + j) + l];
  add_ridge(G_.data(), unknowns, round_off);
  batch_cholesky(G_.data(), unknowns, dependent);
  for (Index c = 0; c < C_; ++c) {
    double* b = G_.data() + batch_entry(unknowns + c, 0);
    batch_solve(G_.data(), unknowns, b);
    for (int l = 0; l < count; ++l) {
      for (Index j = 0; j < Q_; ++j) models.polynomial[Q_ * (C_ * (first + l) + c) + j] = b[L * j + l];
      for (Index j = 0; j < M_; ++j) models.alpha[M_ * (C_ * (first + l) + c) + j] = b[L * (Q_ + j) + l];
    }
  }
}

template <int Dim>
void LocalFitter<Dim>::left_out_errors(Index targets, double* error) {
  if (interpolates())
    interpolant_errors(targets, error);
  else
    least_squares_errors(targets, error);
}

// With E = (A + lambda W^-1)^-1 and the polynomials P, the interpolant has the coefficients M s with
// M = E - E P (P^T E P)^-1 P^T E, and leaving sample k out changes its prediction by (M s)_k / M_kk.
template <int Dim>
void LocalFitter<Dim>::interpolant_errors(Index targets, double* error) {
  const Index width = Q_ + C_, n = n_;
  work_.assign(L * n * (Q_ + targets), 0.0);
  double* EP = work_.data();
  double* unit = EP + L * n * Q_;
  for (Index j = 0; j < Q_; ++j)
    for (Index k = 0; k < n; ++k) std::copy_n(F_.data() + L * (width * k + j), L, EP + L * (n * j + k));
  for (Index t = 0; t < targets; ++t) std::fill_n(unit + L * (n * t + t), L, 1.0);
  batch_solve(A_.data(), n, work_.data(), Q_ + targets);
  std::vector<double> S(batch_matrix_size(Q_)), rhs(static_cast<std::size_t>(L * Q_ * (C_ + targets)));
  std::vector<double> column(L * n);
  for (Index i = 0; i < Q_; ++i) {
    for (Index k = 0; k < n; ++k) std::copy_n(F_.data() + L * (width * k + i), L, column.data() + L * k);
    for (Index j = 0; j <= i; ++j) simd<dot>(column.data(), EP + L * n * j, n, S.data() + batch_entry(i, j));
    for (Index c = 0; c < C_; ++c) simd<dot>(column.data(), s_.data() + L * n * c, n, rhs.data() + L * (Q_ * c + i));
    for (Index t = 0; t < targets; ++t) std::copy_n(EP + L * (n * i + t), L, rhs.data() + L * (Q_ * (C_ + t) + i));
  }
  const std::vector<double> before = rhs;
  if (Q_ > 0) {
    batch_cholesky(S.data(), Q_, dependent);
    batch_solve(S.data(), Q_, rhs.data(), C_ + targets);
  }
  for (Index t = 0; t < targets; ++t) {
    double drop[L];
    simd<dot>(before.data() + L * Q_ * (C_ + t), rhs.data() + L * Q_ * (C_ + t), Q_, drop);
    for (Index c = 0; c < C_; ++c) {
      double shift[L];
      simd<dot>(before.data() + L * Q_ * (C_ + t), rhs.data() + L * Q_ * c, Q_, shift);
      for (int l = 0; l < L; ++l) {
        const double diagonal = unit[L * (n * t + t) + l],
                     M = std::max(diagonal - drop[l], smallest_freedom * diagonal);
        error[(l * C_ + c) * targets + t] = (s_[L * (n * c + t) + l] - shift[l]) / M;
      }
    }
  }
}

// Residual over 1 - h with the leverage h of the sample.
template <int Dim>
void LocalFitter<Dim>::least_squares_errors(Index targets, double* error) {
  const Index unknowns = Q_ + M_, width = unknowns + C_;
  work_.resize(L * unknowns * targets);
  for (Index t = 0; t < targets; ++t)
    std::copy_n(F_.data() + L * width * t, L * unknowns, work_.data() + L * unknowns * t);
  batch_solve(G_.data(), unknowns, work_.data(), targets);
  for (Index t = 0; t < targets; ++t) {
    double leverage[L];
    const double* row = F_.data() + L * width * t;
    simd<dot>(row, work_.data() + L * unknowns * t, unknowns, leverage);
    for (Index c = 0; c < C_; ++c) {
      double fitted[L];
      simd<dot>(row, G_.data() + batch_entry(unknowns + c, 0), unknowns, fitted);
      for (int l = 0; l < L; ++l)
        error[(l * C_ + c) * targets + t] = (row[L * (unknowns + c) + l] - fitted[l]) /
                                            std::max(1 - leverage[l], smallest_freedom) / weight_[L * t + l];
    }
  }
}

#define CSRBF_INSTANTIATE(Dim) template class LocalFitter<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
