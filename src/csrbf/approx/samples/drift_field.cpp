#include "csrbf/approx/samples/drift_field.hpp"

#include "csrbf/approx/samples/many_variables.hpp"
#include "csrbf/core/error.hpp"

#include <algorithm>
#include <limits>
#include <type_traits>

namespace csrbf {
namespace {

// Calls use(field) with a field of E coordinates, std::integral_constant<int, E>() too.
template <class Use>
void visit_field(const AnyField& any, const Use& use) {
  std::visit(
      [&](const auto& field) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(field)>, std::monostate>)
          use(*field, [&]<int E>(const Field<E>&) { return std::integral_constant<int, E>(); }(*field));
      },
      any);
}

int dimension_of(const AnyField& any) {
  int dimension = 0;
  if (!any.valueless_by_exception())
    visit_field(any, [&](const auto& /*field*/, auto of_field) { dimension = decltype(of_field)::value; });
  return dimension;
}

// Values of a field at some of the coordinates of points.
Eigen::VectorXd values_of(const AnyField& any, const Eigen::MatrixXd& y) {
  Eigen::VectorXd values(y.cols());
  visit_field(any, [&](const auto& field, auto dimension) {
    constexpr int E = decltype(dimension)::value;
    field.evaluate_block(with_zeros<E>(y), {values.data(), nullptr, nullptr});
  });
  return values;
}

}  // namespace

template <int Dim>
DriftField<Dim>::DriftField(Parts parts, const Box<Dim>& bounds) : parts_(std::move(parts)), bounds_(bounds) {
  std::vector<bool> is_drift(Dim, false);
  for (const int a : parts_.drift) {
    require(a >= 0 && a < Dim && !is_drift[static_cast<std::size_t>(a)], "DriftField", "drift", a,
            "must be different axes");
    is_drift[static_cast<std::size_t>(a)] = true;
  }
  const int dimension = dimension_of(parts_.field);
  for (int a = 0; a < Dim && std::ssize(others_) < dimension; ++a)
    if (!is_drift[static_cast<std::size_t>(a)]) others_.push_back(a);
  const auto q = std::ssize(parts_.drift);
  const auto has_dimension = [&](const AnyField& field) { return dimension_of(field) == dimension; };
  const bool has_all =
      Dim > largest_dimension ? dimension == Dim || std::ssize(others_) == dimension : dimension + q == Dim;
  const bool fits = dimension > 0 && has_all && parts_.beta.size() == q &&
                    std::all_of(parts_.covariates.begin(), parts_.covariates.end(), has_dimension) &&
                    (parts_.covariates.empty() || std::ssize(parts_.covariates) == q) &&
                    parts_.covariance.rows() == std::ssize(parts_.covariates) &&
                    parts_.covariance.cols() == std::ssize(parts_.covariates);
  require(fits, "DriftField", "parts", q, "the dimensions of the parts do not fit");
}

template <int Dim>
std::vector<Index> DriftField<Dim>::evaluation_order(const PointsRef<Dim>& x) const {
  std::vector<Index> order;
  visit_field(parts_.field, [&](const auto& field, auto dimension) {
    order = field.evaluation_order(with_zeros<decltype(dimension)::value>(x(others_, Eigen::all)));
  });
  return order;
}

template <int Dim>
void DriftField<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  const Index n = x.cols();
  const Eigen::MatrixXd y = x(others_, Eigen::all), z = x(parts_.drift, Eigen::all);
  visit_field(parts_.field, [&](const auto& field, auto dimension) {
    constexpr int E = decltype(dimension)::value;
    Jet<E> jet(n, out.derivatives());
    field.evaluate_block(with_zeros<E>(y), {jet.value.data(), out.gradient != nullptr ? jet.gradient.data() : nullptr,
                                            out.hessian != nullptr ? jet.hessian.data() : nullptr});
    for (Index i = 0; i < n; ++i) {
      out.value[i] = jet.value[i] + parts_.beta.dot(z.col(i));
      if (out.gradient == nullptr) continue;
      Eigen::Map<Point<Dim>> gradient(out.gradient + Dim * i);
      gradient.setZero();
      for (std::size_t a = 0; a < others_.size(); ++a) gradient[others_[a]] = jet.gradient(static_cast<Index>(a), i);
      gradient(parts_.drift) = parts_.beta;
      if (out.hessian == nullptr) continue;
      Eigen::Matrix<double, Dim, Dim> H = Eigen::Matrix<double, Dim, Dim>::Zero();
      const auto inner = jet.hessian_matrix(i);
      for (std::size_t a = 0; a < others_.size(); ++a)
        for (std::size_t b = 0; b < others_.size(); ++b)
          H(others_[a], others_[b]) = inner(static_cast<Index>(a), static_cast<Index>(b));
      double* entry = out.hessian + symmetric_size<Dim> * i;
      for (int a = 0; a < Dim; ++a)
        for (int b = a; b < Dim; ++b) *entry++ = H(a, b);
    }
  });
  if (parts_.covariates.empty()) return;
  Eigen::MatrixXd difference = z;
  for (Index j = 0; j < z.rows(); ++j)
    difference.row(j) -= values_of(parts_.covariates[static_cast<std::size_t>(j)], y).transpose();
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::MatrixXd spread = parts_.covariance * difference;
  for (Index i = 0; i < n; ++i) out.value[i] += difference.col(i).dot(spread.col(i));
  if (out.gradient != nullptr) std::fill_n(out.gradient, Dim * n, nan);
  if (out.hessian != nullptr) std::fill_n(out.hessian, symmetric_size<Dim> * n, nan);
}

#define CSRBF_INSTANTIATE(Dim) template class DriftField<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
