#pragma once

#include "csrbf/implicit/rays/candidate_cells.hpp"

#include <array>
#include <limits>

namespace csrbf {

/// The search for the first zero of a field along a ray, one evaluation at a time, so that many rays can be evaluated
/// together: while not done(), call answer() with the value and the gradient at query().
///
/// In an interval of half-length h around m, with |f''| <= G and |f'| <= L along the ray, there is no zero if |f(m)| >
/// min(L h, |f'(m)| h + G h^2 / 2) (interval refinement; Mitchell 1990, with Taylor's formula as the inclusion), and f
/// is monotone if |f'(m)| > G h (Kalra, Barr 1989). Otherwise the interval is halved, the near half first. In a
/// monotone interval the zero, if there is one, is bracketed and found by Newton's method. Intervals that cannot be
/// divided further contain a zero if f changes sign. Estimated bounds are checked against each evaluation and the
/// previous one; if they are too small they are raised, and conclusions that they invalidate are revised.
class RaySearch {
 public:
  /// `tolerance`: of the distance along the ray; > 0.
  RaySearch(const CandidateCells& cells, const Ray& ray, double t_max, double tolerance)
      : cells_(&cells), ray_(ray), t_max_(t_max), tolerance_(tolerance) {
    next_stretch();
  }

  [[nodiscard]] bool done() const { return step_ == Step::done; }
  [[nodiscard]] const Ray& ray() const { return ray_; }
  [[nodiscard]] Point<3> query() const { return ray_.origin + t_ * ray_.direction; }
  void answer(double value, const Point<3>& gradient);

  /// Once done: whether there is a zero, and where.
  [[nodiscard]] bool hit() const { return hit_; }
  [[nodiscard]] double t() const { return t_; }
  /// The last gradient: that at the zero, up to the tolerance.
  [[nodiscard]] const Point<3>& gradient() const { return gradient_; }

 private:
  enum class Step { isolate, refine, probe, done };
  static constexpr int deepest = 64;  // halvings, beyond the precision of a double

  // An evaluation on the ray.
  struct Sample {
    double t = 0, value = 0, slope = 0;
  };
  // The sign of f at a point of the ray; 0 = unknown.
  struct Known {
    int sign = 0;
    double t = 0;
  };
  // The largest bounds for which all conclusions in the stretch hold.
  struct Allowed {
    double lipschitz = std::numeric_limits<double>::infinity(), hessian_bound = std::numeric_limits<double>::infinity();
  };

  void next_stretch();
  void search_stretch();
  void next_interval();
  bool bounds_hold(const Sample& sample);
  void isolate(double value, double slope);
  void refine(double value, double slope);
  void leave(double value);
  void accept(double t);

  const CandidateCells* cells_;
  Ray ray_;
  double t_max_, tolerance_;
  Step step_ = Step::isolate;
  bool hit_ = false;
  double t_ = 0;  // of the query, or of the hit
  Point<3> gradient_ = Point<3>::Zero();
  CandidateCells::Walk walk_;
  Stretch stretch_;
  std::array<double, deepest> ends_;  // of the remaining intervals of the stretch, the next one last
  int left_ = 0;
  double begin_ = 0, end_ = 0;  // the interval
  Known before_;                // the interval
  Known before_stretch_;
  Sample last_;
  Allowed allowed_;
  bool last_known_ = false;  // in this stretch

  double lo_ = 0, hi_ = 0;  // bracket of a zero
  bool lo_known_ = false, hi_known_ = false;
  int rising_ = 1, steps_ = 0;
};

}  // namespace csrbf
