#include "csrbf/approx/samples/periodic_field.hpp"

#include "csrbf/spatial/chosen_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace csrbf {
namespace {

// Share of a period over which samples are repeated at each end, far enough beyond the seam for its patches. Chosen by
// hand.
constexpr double ghost_share = 0.15;

// s(t) = 35 t^4 - 84 t^5 + 70 t^6 - 20 t^7 and two derivatives.
struct Rise {
  double s, ds, dds;

  explicit Rise(double t) {
    const double u = 1 - t, tu = t * u;
    s = t * t * t * t * (35 - t * (84 - t * (70 - 20 * t)));
    ds = 140 * tu * tu * tu;
    dds = 420 * tu * tu * (u - t);
  }
};

// Adds to out, which holds the jet of inner(x + period), that of s (inner(x) - inner(x + period)) at point i.
template <int Dim>
void blend(const Rise& rise, double slope, int axis, const Jet<Dim>& here, Index k, const JetBlock& out, Index i) {
  const double s = rise.s, ds = rise.ds * slope, dds = rise.dds * slope * slope;
  const double difference = here.value[k] - out.value[i];
  out.value[i] += s * difference;
  if (out.gradient == nullptr) return;
  double* gradient = out.gradient + Dim * i;
  Point<Dim> steps;
  for (int a = 0; a < Dim; ++a) {
    steps[a] = here.gradient(a, k) - gradient[a];
    gradient[a] += s * steps[a] + (a == axis ? ds * difference : 0);
  }
  if (out.hessian == nullptr) return;
  double* hessian = out.hessian + symmetric_size<Dim> * i;
  for (int a = 0, entry = 0; a < Dim; ++a)
    for (int b = a; b < Dim; ++b, ++entry) {
      hessian[entry] += s * (here.hessian(entry, k) - hessian[entry]);
      if (a == axis) hessian[entry] += ds * steps[b];
      if (b == axis) hessian[entry] += ds * steps[a];
      if (a == axis && b == axis) hessian[entry] += dds * difference;
    }
}

// Coordinates wrapped into [lo, lo + period); those that differ only by the rounding of a period become equal.
Eigen::VectorXd wrap(const Eigen::VectorXd& x, double lo, double period) {
  const double rounding =
      8 * std::numeric_limits<double>::epsilon() * (x.cwiseAbs().maxCoeff() + std::abs(lo) + period);
  Eigen::VectorXd c = x.array() - period * ((x.array() - lo) / period).floor();
  std::vector<Index> order(c.size());
  std::iota(order.begin(), order.end(), Index{0});
  for (double& value : c)
    if (value > lo + period - rounding) value = lo;
  std::sort(order.begin(), order.end(), [&](Index i, Index j) { return c[i] < c[j]; });
  for (std::size_t k = 1; k < order.size(); ++k)
    if (c[order[k]] - c[order[k - 1]] <= rounding) c[order[k]] = c[order[k - 1]];
  return c;
}

// Appends copies of samples `source`, at other coordinates along one axis.
template <int Dim>
void append(Samples<Dim>& samples, const std::vector<Index>& source, int axis, const std::vector<double>& coordinate) {
  const Index n = samples.size(), more = static_cast<Index>(source.size());
  samples.points.conservativeResize(Eigen::NoChange, n + more);
  samples.values.conservativeResize(n + more, Eigen::NoChange);
  if (samples.weights.size() > 0) samples.weights.conservativeResize(n + more);
  for (Index i = 0; i < more; ++i) {
    const Index from = source[i];
    samples.points.col(n + i) = samples.points.col(from);
    samples.points(axis, n + i) = coordinate[i];
    samples.values.row(n + i) = samples.values.row(from);
    if (samples.weights.size() > 0) samples.weights[n + i] = samples.weights[from];
  }
}

}  // namespace

template <int Dim>
Points<Dim> PeriodicField<Dim>::wrapped(const PointsRef<Dim>& x) const {
  Points<Dim> y = x;
  y.row(axis_).array() -= period_ * ((y.row(axis_).array() - lo_) / period_).floor();
  return y;
}

template <int Dim>
std::vector<Index> PeriodicField<Dim>::evaluation_order(const PointsRef<Dim>& x) const {
  return inner_->evaluation_order(wrapped(x));
}

template <int Dim>
Box<Dim> PeriodicField<Dim>::bounds() const {
  Box<Dim> box = inner_->bounds();
  box.lo[axis_] = lo_;
  box.hi[axis_] = lo_ + period_;
  return box;
}

template <int Dim>
void PeriodicField<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  const double width = seam_share * period_;
  Points<Dim> y = wrapped(x);
  std::vector<Index> near;  // the points at which the inner field is evaluated twice
  for (Index i = 0; i < y.cols(); ++i)
    if (y(axis_, i) < lo_ + width) near.push_back(i);
  Jet<Dim> here(static_cast<Index>(near.size()), out.derivatives());
  if (!near.empty()) {
    inner_->evaluate_block(chosen_points<Dim>(y, near),
                           {here.value.data(), out.gradient == nullptr ? nullptr : here.gradient.data(),
                            out.hessian == nullptr ? nullptr : here.hessian.data()});
    for (const Index i : near) y(axis_, i) += period_;
  }
  inner_->evaluate_block(y, out);
  for (std::size_t k = 0; k < near.size(); ++k) {
    const double t = (y(axis_, near[k]) - period_ - lo_) / width;
    blend<Dim>(Rise(std::clamp(t, 0.0, 1.0)), 1 / width, axis_, here, static_cast<Index>(k), out, near[k]);
  }
}

template <int Dim>
Samples<Dim> repeat_periodically(const Samples<Dim>& samples, const Point<Dim>& periods, const Point<Dim>& lo) {
  Samples<Dim> result = samples;
  for (int a = 0; a < Dim; ++a) {
    const double period = periods[a];
    if (!(period > 0)) continue;
    result.points.row(a) = wrap(result.points.row(a), lo[a], period);
    std::vector<Index> source;
    std::vector<double> coordinate;
    for (Index i = 0; i < result.size(); ++i)
      for (const double copy : {result.points(a, i) - period, result.points(a, i) + period})
        if (copy > lo[a] - ghost_share * period && copy < lo[a] + (1 + ghost_share) * period) {
          source.push_back(i);
          coordinate.push_back(copy);
        }
    append(result, source, a, coordinate);
  }
  return result;
}

#define CSRBF_INSTANTIATE(Dim)       \
  template class PeriodicField<Dim>; \
  template Samples<Dim> repeat_periodically<Dim>(const Samples<Dim>&, const Point<Dim>&, const Point<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
