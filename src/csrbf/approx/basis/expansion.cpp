#include "csrbf/approx/basis/expansion.hpp"

#include "csrbf/approx/basis/evaluation_order.hpp"
#include "csrbf/approx/basis/polynomial.hpp"
#include "csrbf/approx/sums/fast_sum.hpp"
#include "csrbf/core/once.hpp"
#include "csrbf/spatial/chosen_points.hpp"

namespace csrbf {

template <int Dim>
struct Expansion<Dim>::LazyFarField {
  Once once;
  FarField field;
};

template <int Dim>
Expansion<Dim>::Expansion(std::shared_ptr<const RadialBasis<Dim>> basis, Eigen::VectorXd coefficients,
                          PolynomialTail<Dim> tail, const Box<Dim>& bounds)
    : basis_(std::move(basis)),
      coefficients_(std::move(coefficients)),
      slot_coefficients_(basis_->to_slots(coefficients_)),
      far_field_(std::make_shared<LazyFarField>()),
      tail_(std::move(tail)),
      bounds_(bounds) {
  require(tail_.coefficients.size() == Polynomials<Dim>(tail_.degree).size(), "Expansion", "tail.coefficients",
          tail_.coefficients.size(), "there must be one per monomial of the degree");
  require(std::isfinite(tail_.scale) && tail_.scale > 0, "Expansion", "tail.scale", tail_.scale, "must be positive");
  if (bounds_.empty()) bounds_ = bounding_box<Dim>(basis_->centers());
}

template <int Dim>
double Expansion<Dim>::feature_size() const {
  return basis_->size() == 0 ? 0 : basis_->supports().minCoeff();
}

template <int Dim>
std::vector<Index> Expansion<Dim>::evaluation_order(const PointsRef<Dim>& x) const {
  const FastSum<Dim>* const fast = basis_->fast_sum();
  if (!basis_->kernel().compact() && fast == nullptr) return {};
  if (fast != nullptr) static_cast<void>(far_field(*fast));  // here, where all threads are free
  return evaluation_order_of<Dim>(x);
}

template <int Dim>
void Expansion<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  const Index n = x.cols();
  std::fill_n(out.value, n, 0.0);
  if (out.gradient != nullptr) std::fill_n(out.gradient, Dim * n, 0.0);
  if (out.hessian != nullptr) std::fill_n(out.hessian, symmetric_size<Dim> * n, 0.0);
  if (const FastSum<Dim>* const fast = basis_->fast_sum(); fast != nullptr)
    add_fast_sums(*fast, x, out);
  else if (basis_->size() > 0)
    basis_->add_sums(x, slot_coefficients_, out);
  if (tail_.degree < 0) return;
  for (Index begin = 0; begin < n; begin += this->block_size)  // all monomials of these points are in memory at once
    add_tail(x.middleCols(begin, std::min(this->block_size, n - begin)), out.template from<Dim>(begin));
}

template <int Dim>
const FarField& Expansion<Dim>::far_field(const FastSum<Dim>& fast) const {
  far_field_->once.call([&] {
    if constexpr (Dim <= 3) far_field_->field = fast.expand(coefficients_);
  });
  return far_field_->field;
}

template <int Dim>
void Expansion<Dim>::add_fast_sums(const FastSum<Dim>& fast, const PointsRef<Dim>& x, const JetBlock& out) const {
  if constexpr (Dim <= 3) {
    const FarField& field = far_field(fast);
    const auto& transforms = basis_->metric().transforms;
    if (transforms.empty()) return fast.add_sums(field, x, out);
    const Eigen::Matrix<double, Dim, Dim>& T = transforms.front();
    fast.add_sums(field, Points<Dim>(T * x), out);
    for (Index k = 0; k < x.cols(); ++k) {
      if (out.gradient != nullptr) {
        Eigen::Map<Point<Dim>> gradient(out.gradient + Dim * k);
        gradient = (T.transpose() * gradient).eval();
      }
      if (out.hessian == nullptr) continue;
      double* const triangle = out.hessian + symmetric_size<Dim> * k;
      Eigen::Matrix<double, Dim, Dim> H;
      for (int a = 0, entry = 0; a < Dim; ++a)
        for (int b = a; b < Dim; ++b, ++entry) H(a, b) = H(b, a) = triangle[entry];
      H = (T.transpose() * H * T).eval();
      for (int a = 0, entry = 0; a < Dim; ++a)
        for (int b = a; b < Dim; ++b, ++entry) triangle[entry] = H(a, b);
    }
  }
}

template <int Dim>
std::optional<Enclosure> Expansion<Dim>::enclose(const Box<Dim>& box) const {
  constexpr int highest_degree = 2;  // with constant second derivatives
  const Kernel& kernel = basis_->kernel();
  const RadialMetric<Dim>& metric = basis_->metric();
  const bool bounded = kernel.name().starts_with("wendland-") && kernel.smoothness() >= 2 &&
                       metric.transforms.empty() && metric.periods.isZero() && tail_.degree <= highest_degree;
  if (!bounded) return std::nullopt;
  const double phi2 = std::abs(kernel.g(0));
  double bend = 0;
  for (const Index j : basis_->reaching(box)) {
    const double support = basis_->support(j);
    const Point<Dim> c = basis_->centers().col(j);
    if ((c - c.cwiseMax(box.lo).cwiseMin(box.hi)).squaredNorm() < support * support)
      bend += std::abs(coefficients_[j]) * phi2 / (support * support);
  }
  if (tail_.degree == highest_degree) {
    Jet<Dim> tail(1, Derivatives::hessian);
    tail.value.setZero();
    tail.gradient.setZero();
    tail.hessian.setZero();
    add_tail(box.center(), {tail.value.data(), tail.gradient.data(), tail.hessian.data()});
    bend += tail.hessian_matrix(0).norm();
  }
  const Jet<Dim> center = this->evaluate(box.center(), Derivatives::gradient);
  const double r = 0.5 * box.diagonal(), slope = center.gradient.col(0).norm();
  const double change = r * (slope + 0.5 * bend * r);
  return Enclosure{center.value[0] - change, center.value[0] + change, slope + bend * r, bend};
}

template <int Dim>
void Expansion<Dim>::add_tail(const PointsRef<Dim>& x, const JetBlock& out) const {
  const Index n = x.cols();
  if (tail_.degree == 0) {
    Eigen::Map<Eigen::VectorXd>(out.value, n).array() += tail_.coefficients[0];
    return;
  }
  const Polynomials<Dim> polynomials(tail_.degree);
  const Derivatives wanted = out.derivatives();
  const Points<Dim> local = in_units<Dim>(x, tail_.origin, tail_.scale);
  const Index Q = polynomials.size();
  Eigen::MatrixXd value(n, Q);
  Eigen::MatrixXd gradient(wanted >= Derivatives::gradient ? n * Dim : 0, Q);
  Eigen::MatrixXd hessian(wanted >= Derivatives::hessian ? n * symmetric_size<Dim> : 0, Q);
  polynomials.rows(local, value.data(), gradient.size() > 0 ? gradient.data() : nullptr,
                   hessian.size() > 0 ? hessian.data() : nullptr);
  Eigen::Map<Eigen::VectorXd>(out.value, n) += value * tail_.coefficients;
  if (wanted >= Derivatives::gradient)
    Eigen::Map<Eigen::VectorXd>(out.gradient, n * Dim) += gradient * tail_.coefficients / tail_.scale;
  if (wanted >= Derivatives::hessian)
    Eigen::Map<Eigen::VectorXd>(out.hessian, n * symmetric_size<Dim>) +=
        hessian * tail_.coefficients / (tail_.scale * tail_.scale);
}

#define CSRBF_INSTANTIATE(Dim) template class Expansion<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
