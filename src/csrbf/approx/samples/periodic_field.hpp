#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/core/field.hpp"

#include <memory>
#include <utility>

namespace csrbf {

/// A field that repeats along one axis, made from one that is known over a period and a little beyond it:
///
///     f(x) = s(t) inner(x) + (1 - s(t)) inner(x + period),   t = (x_axis - lo) / (seam_share period)
///
/// for coordinates x_axis wrapped into [lo, lo + period), with a polynomial s that rises from 0 to 1 and has three
/// vanishing derivatives at both ends. At the seam both sides are inner(x + period) with all derivatives that s and the
/// inner field have, so f is as smooth there as elsewhere. Periodic up to the rounding of coordinates.
template <int Dim>
class PeriodicField : public Field<Dim> {
 public:
  /// Where the two copies are blended, as a share of the period; the inner field is evaluated from lo to
  /// lo + (1 + seam_share) period. Chosen by hand: a wider seam is gentler, but evaluates more points twice.
  static constexpr double seam_share = 0.05;

  PeriodicField(std::shared_ptr<const Field<Dim>> inner, int axis, double lo, double period)
      : inner_(std::move(inner)), axis_(axis), lo_(lo), period_(period) {}

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override;
  [[nodiscard]] Box<Dim> bounds() const override;
  [[nodiscard]] double feature_size() const override { return inner_->feature_size(); }

 private:
  [[nodiscard]] Points<Dim> wrapped(const PointsRef<Dim>& x) const;

  std::shared_ptr<const Field<Dim>> inner_;
  int axis_;
  double lo_, period_;
};

/// The samples of a function with periods (0: none), wrapped into the first period from `lo` on, followed by copies of
/// those near its ends, as needed by the inner field of a PeriodicField. Coordinates on periodic axes that differ by no
/// more than the rounding of a period become equal, so that samples at the same point can be merged. O(n log n).
template <int Dim>
Samples<Dim> repeat_periodically(const Samples<Dim>& samples, const Point<Dim>& periods, const Point<Dim>& lo);

}  // namespace csrbf
