#include "csrbf/surface/medial/medial_axis_field.hpp"

#include <type_traits>
#include <utility>

namespace csrbf {
namespace {

// Chosen by hand. The balls are trusted where the sum of their weights exceeds `trusted_weight` (as in
// composite_field.cpp) and |u|, u = 2 w - 1 with the winding number w, is below `undecided`; above `decided` not at
// all. Larger values of the latter two: the balls decide further away from the surface.
constexpr double trusted_weight = 0.04;
constexpr double undecided = 0.75;
constexpr double decided = 0.92;

double value_of(double x) {
  return x;
}
double value_of(const Taylor<3>& x) {
  return x.value;
}

template <class Scalar>
Scalar column(const Jet<3>& jet, Index i) {
  if constexpr (std::is_same_v<Scalar, double>) {
    return jet.value[i];
  } else {
    Scalar t(jet.value[i]);
    t.gradient = jet.gradient.col(i);
    if (jet.hessian.cols() > 0) t.hessian = jet.hessian_matrix(i);
    return t;
  }
}

// Weight of the balls, in [0, 1].
template <class Scalar>
Scalar trust(const Scalar& W, const Scalar& u) {
  const double certainty = std::abs(value_of(u));
  if (value_of(W) <= 0 || certainty >= decided) return Scalar(0.0);
  const Scalar covered = smooth_step((1 / trusted_weight) * W);
  if (certainty <= undecided) return covered;
  const Scalar magnitude = value_of(u) < 0 ? Scalar((-1.0) * u) : u;
  return covered * (1.0 - smooth_step((1 / (decided - undecided)) * (magnitude - undecided)));
}

void store(double f, Index i, const JetBlock& out) {
  out.value[i] = f;
}

}  // namespace

MedialAxisField::MedialAxisField(Data data)
    : data_(std::move(data)), balls_(data_.centers, data_.supports, data_.quadrics) {}

// f = t S / W + (1 - t) far_value u.
template <class Scalar>
void MedialAxisField::blend(const Jet<3>& winding, const BallSums& sums, Index i, const JetBlock& out) const {
  const auto u = column<Scalar>(winding, i);
  const auto W = total<Scalar>(sums.W, out.derivatives());
  const Scalar t = trust(W, u), far = data_.far_value * u;
  if (value_of(t) <= 0) {
    store(far, i, out);
  } else {
    store(Scalar(t * (total<Scalar>(sums.S, out.derivatives()) / W) + (1.0 - t) * far), i, out);
  }
}

void MedialAxisField::evaluate_block(const PointsRef<3>& x, const JetBlock& out) const {
  const Derivatives wanted = out.derivatives();
  Jet<3> winding(x.cols(), wanted);
  data_.winding.evaluate_block(
      x, {winding.value.data(), wanted >= Derivatives::gradient ? winding.gradient.data() : nullptr,
          wanted >= Derivatives::hessian ? winding.hessian.data() : nullptr});
  BallTree::Runs runs;
  BallSums sums;
  for (Index i = 0; i < x.cols(); ++i) {
    balls_.sum(x.col(i), wanted, runs, sums);
    if (wanted == Derivatives::none) {
      blend<double>(winding, sums, i, out);
    } else {
      blend<Taylor<3>>(winding, sums, i, out);
    }
  }
}

}  // namespace csrbf
