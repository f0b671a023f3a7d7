#include "csrbf/approx/samples/fitted_field.hpp"

#include "csrbf/approx/samples/periodic_field.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/usual_extent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

template <int Dim>
bool contains(const Box<Dim>& box, const PointsRef<Dim>& x) {
  for (Index i = 0; i < x.cols(); ++i)
    if (!box.contains(x.col(i))) return false;
  return true;
}

template <int Dim>
bool has_slope_outside(const typename FittedField<Dim>::Frame& frame) {
  return frame.extrapolation == Extrapolation::linear ||
         (frame.extrapolation == Extrapolation::constant && frame.rim.maxCoeff() > 0);
}

// Whether inside the box the coordinates of the inner field are those of the user.
template <int Dim>
bool is_same_inside(const typename FittedField<Dim>::Frame& frame) {
  return frame.periods.isZero() && frame.scales == Point<Dim>::Ones() && frame.unit == 1;
}

}  // namespace

template <int Dim>
FittedField<Dim>::FittedField(std::shared_ptr<const Field<Dim>> inner, const Frame& frame)
    : inner_(std::move(inner)), repeated_(inner_), frame_(frame) {
  if (frame.extrapolation == Extrapolation::automatic) frame_.extrapolation = Extrapolation::constant;
  for (int a = 0; a < Dim; ++a)
    if (frame.periods[a] > 0)
      repeated_ = std::make_shared<const PeriodicField<Dim>>(repeated_, a, frame.box.lo[a] / frame.scales[a],
                                                             frame.periods[a] / frame.scales[a]);
}

template <int Dim>
std::shared_ptr<const FittedField<Dim>> FittedField<Dim>::in_units(const Point<Dim>& coordinates, double values) const {
  Frame frame = frame_;
  for (auto* lengths : {&frame.scales, &frame.periods, &frame.rim, &frame.box.lo, &frame.box.hi})
    *lengths = lengths->cwiseProduct(coordinates);
  frame.unit *= values;
  return std::make_shared<const FittedField>(inner_, frame);
}

template <int Dim>
Point<Dim> FittedField<Dim>::map(const Point<Dim>& x, std::array<bool, Dim>& outside) const {
  Point<Dim> y;
  for (int a = 0; a < Dim; ++a) {
    const bool is_free = frame_.periods[a] > 0 || frame_.extrapolation == Extrapolation::trend;
    const double inside = is_free ? x[a] : std::clamp(x[a], frame_.box.lo[a], frame_.box.hi[a]);
    outside[a] = inside != x[a];
    y[a] = inside / frame_.scales[a];
  }
  return y;
}

template <int Dim>
Point<Dim> FittedField<Dim>::rim_of(const PointsRef<Dim>& samples) {
  const Point<Dim> extent = usual_extent<Dim>(samples);
  const Index axes = std::clamp<Index>((extent.array() > 0).count(), 1, 3);  // more would make it all of the extent
  return extent / std::pow(static_cast<double>(samples.cols()), 1.0 / static_cast<double>(axes));
}

template <int Dim>
double FittedField<Dim>::reach(int axis) const {
  return frame_.extrapolation == Extrapolation::linear ? std::numeric_limits<double>::infinity()
                                                       : frame_.rim[axis] / frame_.scales[axis];
}

template <int Dim>
double FittedField<Dim>::bound(const Point<Dim>& x) const {
  double farthest = 0;
  for (int a = 0; a < Dim; ++a) {
    const double beyond = std::max(frame_.box.lo[a] - x[a], x[a] - frame_.box.hi[a]);
    const double extent = frame_.box.extent()[a];
    if (extent > 0 && frame_.periods[a] == 0) farthest = std::max(farthest, beyond / extent);
  }
  return farthest > 0 ? frame_.growth.largest * (1 + farthest) * (1 + farthest)
                      : std::numeric_limits<double>::infinity();
}

template <int Dim>
std::vector<Index> FittedField<Dim>::evaluation_order(const PointsRef<Dim>& x) const {
  if (is_same_inside<Dim>(frame_)) return repeated_->evaluation_order(x);
  Points<Dim> y(Dim, x.cols());
  parallel_for(x.cols(), 4096, [&](Index begin, Index end) {
    std::array<bool, Dim> outside;
    for (Index i = begin; i < end; ++i) y.col(i) = map(x.col(i), outside);
  });
  return repeated_->evaluation_order(y);
}

template <int Dim>
void FittedField<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  evaluate_in_unit(x, out);
  if (frame_.unit == 1) return;
  const auto scale = [&](double* from, Index count) {
    if (from != nullptr) Eigen::Map<Eigen::VectorXd>(from, count) *= frame_.unit;
  };
  scale(out.value, x.cols());
  scale(out.gradient, Dim * x.cols());
  scale(out.hessian, symmetric_size<Dim> * x.cols());
}

template <int Dim>
void FittedField<Dim>::evaluate_in_unit(const PointsRef<Dim>& x, const JetBlock& out) const {
  if (is_same_inside<Dim>(frame_) && contains<Dim>(frame_.box, x)) return repeated_->evaluate_block(x, out);
  Points<Dim> y(Dim, x.cols());
  std::vector<std::array<bool, Dim>> outside(x.cols());
  bool any_outside = false;
  for (Index i = 0; i < x.cols(); ++i) {
    y.col(i) = map(x.col(i), outside[i]);
    any_outside = any_outside || std::find(outside[i].begin(), outside[i].end(), true) != outside[i].end();
  }
  if (any_outside && has_slope_outside<Dim>(frame_)) return continue_linearly(x, y, outside, out);
  repeated_->evaluate_block(y, out);
  const bool is_bounded = frame_.extrapolation == Extrapolation::trend && frame_.growth.largest > 0;
  for (Index i = 0; i < x.cols(); ++i) {
    const std::array<bool, Dim>& moved = outside[i];
    const bool any = std::find(moved.begin(), moved.end(), true) != moved.end();
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    if (is_bounded) out.value[i] = std::min(out.value[i], bound(x.col(i)));
    const bool undefined = !x.col(i).allFinite() || (any && frame_.extrapolation == Extrapolation::nan);
    if (undefined) out.value[i] = nan;
    if (any && frame_.growth.amount > 0) {
      const double distance = (x.col(i).cwiseQuotient(frame_.scales) - y.col(i)).norm();
      out.value[i] +=
          std::min(frame_.growth.amount * std::pow(distance, frame_.growth.exponent), frame_.growth.largest);
    }
    // A coordinate that was moved to the box has no influence.
    const auto factor = [&](int a) { return moved[a] ? 0.0 : 1 / frame_.scales[a]; };
    if (out.gradient != nullptr)
      for (int a = 0; a < Dim; ++a) out.gradient[Dim * i + a] = undefined ? nan : out.gradient[Dim * i + a] * factor(a);
    if (out.hessian == nullptr) continue;
    double* entry = out.hessian + symmetric_size<Dim> * i;
    for (int a = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b, ++entry) *entry = undefined ? nan : *entry * factor(a) * factor(b);
  }
}

// f(y) + sum_a f_a(y) (x - y)_a over the axes a along which x is outside, y the nearest point of the box, and no
// farther than the slope is followed; in second derivatives third ones are left out.
template <int Dim>
void FittedField<Dim>::continue_linearly(const PointsRef<Dim>& x, const Points<Dim>& y,
                                         const std::vector<std::array<bool, Dim>>& outside, const JetBlock& out) const {
  constexpr Index entries = symmetric_size<Dim>;
  const Index n = x.cols();
  Eigen::Matrix<double, Dim, Eigen::Dynamic> gradient(Dim, n);
  Eigen::Matrix<double, entries, Eigen::Dynamic> hessian(entries, out.gradient != nullptr ? n : 0);
  repeated_->evaluate_block(y, {out.value, gradient.data(), out.gradient != nullptr ? hessian.data() : nullptr});
  for (Index i = 0; i < n; ++i) {
    if (!x.col(i).allFinite()) {
      constexpr double nan = std::numeric_limits<double>::quiet_NaN();
      out.value[i] = nan;
      if (out.gradient != nullptr) std::fill_n(out.gradient + Dim * i, Dim, nan);
      if (out.hessian != nullptr) std::fill_n(out.hessian + entries * i, entries, nan);
      continue;
    }
    Point<Dim> step = x.col(i).cwiseQuotient(frame_.scales) - y.col(i);
    std::array<bool, Dim> is_flat{};  // along an axis
    for (int a = 0; a < Dim; ++a) {
      const double most = outside[i][a] ? reach(a) : 0;
      is_flat[a] = outside[i][a] && std::abs(step[a]) > most;
      step[a] = std::clamp(step[a], -most, most);
    }
    out.value[i] += gradient.col(i).dot(step);
    if (out.gradient == nullptr) continue;
    Eigen::Matrix<double, Dim, Dim> H;
    for (int a = 0, entry = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b, ++entry) H(a, b) = H(b, a) = hessian(entry, i);
    const Point<Dim> turned = H * step;
    for (int a = 0; a < Dim; ++a)
      out.gradient[Dim * i + a] =
          is_flat[a] ? 0 : (gradient(a, i) + (outside[i][a] ? 0 : turned[a])) / frame_.scales[a];
    if (out.hessian == nullptr) continue;
    double* to = out.hessian + entries * i;
    for (int a = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b)
        *to++ = (outside[i][a] && outside[i][b]) || is_flat[a] || is_flat[b]
                    ? 0
                    : H(a, b) / frame_.scales[a] / frame_.scales[b];
  }
}

// The coordinates of the inner field along an axis depend on those along that axis only. What else there is outside is
// evaluated once more.
template <int Dim>
Eigen::VectorXd FittedField<Dim>::evaluate_grid(const GridAxes<Dim>& axes) const {
  constexpr Index at_once = 1 << 16;
  GridAxes<Dim> mapped = axes;
  std::array<std::vector<bool>, Dim> is_outside;
  bool any = false;
  for (std::size_t a = 0; a < Dim; ++a)
    for (double& coordinate : mapped[a]) {
      if (!std::isfinite(coordinate)) return Field<Dim>::evaluate_grid(axes);
      std::array<bool, Dim> outside;
      coordinate = map(Point<Dim>::Constant(coordinate), outside)[static_cast<Index>(a)];
      is_outside[a].push_back(outside[a]);
      any = any || outside[a];
    }
  Eigen::VectorXd value = frame_.unit * repeated_->evaluate_grid(mapped);
  const bool is_nan = frame_.extrapolation == Extrapolation::nan;
  if (!any || !(is_nan || has_slope_outside<Dim>(frame_) || frame_.growth.amount > 0)) return value;
  parallel_for((value.size() + at_once - 1) / at_once, 1, [&](Index first, Index last) {
    std::vector<Index> nodes;
    std::vector<Point<Dim>> places;
    for (Index node = first * at_once; node < std::min(last * at_once, value.size()); ++node) {
      Point<Dim> x;
      bool outside = false;
      Index rest = node;
      for (std::size_t a = 0; a < Dim; ++a) {
        const Index k = rest % axes[a].size();
        rest /= axes[a].size();
        x[static_cast<Index>(a)] = axes[a][k];
        outside = outside || is_outside[a][static_cast<std::size_t>(k)];
      }
      if (!outside) continue;
      nodes.push_back(node);
      places.push_back(x);
    }
    if (nodes.empty()) return;
    const Eigen::Map<const Points<Dim>> points(places.front().data(), Dim, std::ssize(places));
    value(nodes) = this->evaluate(points).value;
  });
  return value;
}

template <int Dim>
std::optional<Enclosure> FittedField<Dim>::enclose(const Box<Dim>& box) const {
  if (frame_.unit != 1 || !frame_.periods.isZero() || frame_.extrapolation != Extrapolation::constant ||
      frame_.growth.amount > 0)
    return std::nullopt;
  const auto mapped = [&](const Point<Dim>& x) -> Point<Dim> {
    return x.cwiseMax(frame_.box.lo).cwiseMin(frame_.box.hi).cwiseQuotient(frame_.scales);
  };
  std::optional<Enclosure> enclosure = inner_->enclose({mapped(box.lo), mapped(box.hi)});
  if (!enclosure) return std::nullopt;
  const double scale = frame_.scales.minCoeff();
  enclosure->lipschitz /= scale;
  enclosure->hessian_bound /= scale * scale;
  // Outside, the slope is followed for a while, and the gradient jumps.
  const bool is_inside = frame_.box.contains(box.lo) && frame_.box.contains(box.hi);
  if (!is_inside && frame_.rim.maxCoeff() > 0) return std::nullopt;
  if (!is_inside) enclosure->hessian_bound = std::numeric_limits<double>::infinity();
  return enclosure;
}

#define CSRBF_INSTANTIATE(Dim) template class FittedField<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
