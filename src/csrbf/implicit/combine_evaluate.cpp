#include "csrbf/core/taylor.hpp"
#include "csrbf/implicit/combine.hpp"

#include <type_traits>

namespace csrbf {
namespace {

double value_of(double x) {
  return x;
}
double value_of(const Taylor<3>& x) {
  return x.value;
}

// A function of x with value f and derivatives f1, f2.
double apply(double /*x*/, double f, double /*f1*/, double /*f2*/) {
  return f;
}

template <class Scalar>
Scalar power(const Scalar& x, double exponent) {
  const double v = value_of(x), p = std::pow(v, exponent);
  return apply(x, p, exponent * p / v, exponent * (exponent - 1) * p / (v * v));
}

template <class Scalar>
Scalar exponential(const Scalar& x) {
  const double e = std::exp(value_of(x));
  return apply(x, e, e, e);
}

template <class Scalar>
Scalar logarithm(const Scalar& x) {
  const double v = value_of(x);
  return apply(x, std::log(v), 1 / v, -1 / (v * v));
}

template <class Scalar>
const Scalar& largest(std::span<const Scalar> f) {
  return *std::max_element(f.begin(), f.end(),
                           [](const Scalar& a, const Scalar& b) { return value_of(a) < value_of(b); });
}

// Where both are zero the root has no derivatives; 0 is used.
template <class Scalar>
Scalar evaluate_union(const Scalar& f, const Scalar& g) {
  const Scalar squares = f * f + g * g;
  return value_of(squares) > 0 ? f + g + power(squares, 0.5) : f + g;
}

// In units of the largest term, so that no power overflows. Where all functions are below -R the sum is empty and the
// largest function is used.
template <class Scalar>
Scalar evaluate_super_elliptic(std::span<const Scalar> f, double R, double b) {
  const Scalar& most = largest(f);
  const double unit = 1 + value_of(most) / R;
  if (!(unit > 0)) return most;
  Scalar sum(0.0);
  for (const Scalar& part : f) {
    const Scalar v = (1 / unit) * (1.0 + (1 / R) * part);
    if (value_of(v) > 0) sum = sum + power(v, b);
  }
  return R * (unit * power(sum, 1 / b) - 1.0);
}

template <class Scalar>
Scalar log_sum_exp(std::span<const Scalar> f, double R, double b) {
  const double most = value_of(largest(f)), alpha = b / R;
  Scalar sum(0.0);
  for (const Scalar& part : f) sum = sum + exponential(Scalar(alpha * (part - most)));
  return most + (1 / alpha) * logarithm(sum);
}

template <class Scalar>
Scalar evaluate_united(std::span<const Scalar> f, const CombinedField::Data& data) {
  switch (data.blending) {
    case Blending::super_elliptic:
      return f.size() == 1 ? f[0] : evaluate_super_elliptic(f, data.range, data.sharpness);
    case Blending::log_sum_exp:
      return f.size() == 1 ? f[0] : log_sum_exp(f, data.range, data.sharpness);
    case Blending::r_function: {
      Scalar result = f[0];
      for (std::size_t i = 1; i < f.size(); ++i) result = evaluate_union(result, f[i]);
      return result;
    }
    case Blending::sharp:
      break;
  }
  return largest(f);
}

template <class Scalar>
Scalar load(const Jet<3>& jet, Index i) {
  if constexpr (std::is_same_v<Scalar, double>) {
    return jet.value[i];
  } else {
    Scalar f(jet.value[i]);
    f.gradient = jet.gradient.col(i);
    if (jet.hessian.cols() > 0) f.hessian = jet.hessian_matrix(i);
    return f;
  }
}

void store(double f, Index i, const JetBlock& out) {
  out.value[i] = f;
}
void store(const Taylor<3>& f, Index i, const JetBlock& out) {
  out.value[i] = f.value;
  if (out.gradient != nullptr) Eigen::Map<Point<3>>(out.gradient + 3 * i) = f.gradient;
  if (out.hessian == nullptr) return;
  for (int a = 0, entry = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b, ++entry) out.hessian[6 * i + entry] = f.hessian(a, b);
}

}  // namespace

template <class Scalar>
void CombinedField::evaluate_as(const PointsRef<3>& x, const JetBlock& out) const {
  const Derivatives derivatives = out.derivatives();
  std::vector<Jet<3>> jets;
  jets.reserve(data_.terms.size());
  for (const Term& term : data_.terms) {
    Jet<3>& jet = jets.emplace_back(x.cols(), derivatives);
    term.solid->evaluate_block(x,
                               {jet.value.data(), derivatives >= Derivatives::gradient ? jet.gradient.data() : nullptr,
                                derivatives >= Derivatives::hessian ? jet.hessian.data() : nullptr});
  }
  std::vector<Scalar> f(jets.size());
  const double sign = data_.complemented ? -1 : 1;
  for (Index i = 0; i < x.cols(); ++i) {
    for (std::size_t k = 0; k < jets.size(); ++k)
      f[k] = (data_.terms[k].complemented ? -1.0 : 1.0) * load<Scalar>(jets[k], i);
    store(Scalar(sign * evaluate_united(std::span<const Scalar>(f), data_)), i, out);
  }
}

void CombinedField::evaluate_block(const PointsRef<3>& x, const JetBlock& out) const {
  if (out.derivatives() == Derivatives::none) {
    evaluate_as<double>(x, out);
  } else {
    evaluate_as<Taylor<3>>(x, out);
  }
}

}  // namespace csrbf
