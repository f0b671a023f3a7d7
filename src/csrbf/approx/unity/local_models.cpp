#include "csrbf/approx/unity/local_models.hpp"

#include "csrbf/approx/unity/lane_sums.hpp"

namespace csrbf {
namespace {

constexpr int lanes = 8;

// q becomes T q for every lane; T by columns.
template <int Dim>
void into_metric(const double* T, double* q) {
  double from[Dim * lanes];
  std::copy_n(q, Dim * lanes, from);
  for (int a = 0; a < Dim; ++a)
    for (int l = 0; l < lanes; ++l) {
      double sum = 0;
      for (int b = 0; b < Dim; ++b) sum += T[Dim * b + a] * from[lanes * b + l];
      q[lanes * a + l] = sum;
    }
}

// The derivatives of f(T x) from those of f: T^T g and T^T H T.
template <int Dim>
void out_of_metric(const double* T, int terms, double* f) {
  const Eigen::Map<const Eigen::Matrix<double, Dim, Dim>> transform(T);
  for (int l = 0; l < lanes; ++l) {
    Point<Dim> g;
    for (int a = 0; a < Dim; ++a) g[a] = f[lanes * (1 + a) + l];
    g = (transform.transpose() * g).eval();
    for (int a = 0; a < Dim; ++a) f[lanes * (1 + a) + l] = g[a];
    if (terms == 1 + Dim) continue;
    Eigen::Matrix<double, Dim, Dim> H;
    for (int a = 0, t = 1 + Dim; a < Dim; ++a)
      for (int b = a; b < Dim; ++b, ++t) H(a, b) = H(b, a) = f[lanes * t + l];
    H = (transform.transpose() * H * transform).eval();
    for (int a = 0, t = 1 + Dim; a < Dim; ++a)
      for (int b = a; b < Dim; ++b, ++t) f[lanes * t + l] = H(a, b);
  }
}

}  // namespace

template <int Dim>
void LocalModels<Dim>::resize(Index models) {
  center.resize(Dim, models);
  radius.resize(models);
  metric.resize(static_cast<std::size_t>(anisotropic ? Dim * Dim * models : 0));
  position.resize(Dim * centers_each * models);
  alpha.resize(components * centers_each * models);
  polynomial.resize(components * polynomial_size() * models);
}

template <int Dim>
LocalEvaluator<Dim>::LocalEvaluator(const LocalModels<Dim>& models) : models_(models) {
  const Polynomials<Dim> basis(models.degree);
  for (const auto& step : basis.steps()) {
    parent_.push_back(static_cast<std::int16_t>(step.parent));
    axis_.push_back(static_cast<std::int16_t>(step.axis));
  }
  nested_order_ = nested_order(basis);
  nested_.resize(nested_order_.size());
  const auto M = static_cast<std::size_t>(lanes * models.centers_each);
  q_.resize(Dim * lanes);
  monomial_.resize(lanes * terms * basis.size());
  r2_.resize(M);
  phi_.resize(M);
  g_.resize(M);
  h_.resize(M);
}

template <int Dim>
void LocalEvaluator<Dim>::evaluate(Index i, Index component, const double* x, Derivatives derivatives,
                                   double (*f)[lanes]) {
  const int wanted = derivatives == Derivatives::none ? 1 : derivatives == Derivatives::gradient ? 1 + Dim : terms;
  const double inverse = 1 / models_.radius[i];
  for (int a = 0; a < Dim; ++a)
    for (int l = 0; l < lanes; ++l) q_[lanes * a + l] = (x[lanes * a + l] - models_.center(a, i)) * inverse;
  const double* metric = models_.anisotropic ? models_.metric.data() + Dim * Dim * i : nullptr;
  if (metric != nullptr) into_metric<Dim>(metric, q_.data());
  const double* q = q_.data();

  // The polynomial; its coefficients are put in order once for all points of a model.
  const Index Q = models_.polynomial_size();
  const Index first = (i * models_.components + component) * Q;
  const double* c = models_.polynomial.data() + first;
  if (wanted > 1) lane_sums::polynomial(q, Dim, parent_.data(), axis_.data(), Q, c, wanted, monomial_.data(), f[0]);
  if (Q == 0) {
    std::fill_n(f[0], lanes, 0.0);
  } else {  // so that the value does not depend on whether derivatives are wanted
    if (first != first_)
      std::transform(nested_order_.begin(), nested_order_.end(), nested_.begin(), [&](Index j) { return c[j]; });
    first_ = first;
    lane_sums::nested_polynomial(q, Dim, models_.degree, nested_.data(), f[0]);
  }

  // The radial functions.
  const Index M = models_.centers_each;
  if (M > 0) {
    const double* centers = models_.position.data() + Dim * M * i;
    const double* alpha = models_.alpha.data() + (i * models_.components + component) * M;
    const double scale = 1 / (models_.support * models_.support);
    lane_sums::distances(q, Dim, centers, M, scale, r2_.data());
    if (derivatives == Derivatives::none) {
      models_.kernel.values(r2_.data(), lanes * M, phi_.data());
    } else if (derivatives == Derivatives::gradient) {
      models_.kernel.gradients(r2_.data(), lanes * M, phi_.data(), g_.data());
    } else {
      models_.kernel.hessians(r2_.data(), lanes * M, phi_.data(), g_.data(), h_.data());
    }
    lane_sums::add_values(phi_.data(), alpha, M, f[0]);
    if (derivatives >= Derivatives::gradient)
      lane_sums::add_gradients(g_.data(), alpha, M, q, Dim, centers, scale, f[0]);
    if (derivatives == Derivatives::hessian)
      lane_sums::add_hessians(g_.data(), h_.data(), alpha, M, q, Dim, centers, scale, f[0]);
  }
  for (int t = 1; t < wanted; ++t)
    for (int l = 0; l < lanes; ++l) f[t][l] *= t <= Dim ? inverse : inverse * inverse;
  if (metric != nullptr && wanted > 1) out_of_metric<Dim>(metric, wanted, f[0]);
}

#define CSRBF_INSTANTIATE(Dim)      \
  template struct LocalModels<Dim>; \
  template class LocalEvaluator<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
