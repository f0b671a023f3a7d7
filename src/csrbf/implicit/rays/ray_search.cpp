#include "csrbf/implicit/rays/ray_search.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr int most_newton_steps = 8;     // then bisection
constexpr int most_steps = 80;           // of both: more than bisection of a double needs
constexpr double raise_factor = 1.5;     // of a raised bound over the derivative found; larger: fewer revisions, slower
constexpr double least_distance = 1e-3;  // cells: second derivatives from closer evaluations are rounding

}  // namespace

void RaySearch::next_stretch() {
  if (!cells_->next(ray_, t_max_, walk_, stretch_)) {
    step_ = Step::done;
    return;
  }
  before_stretch_ = before_;
  search_stretch();
}

void RaySearch::search_stretch() {
  before_ = before_stretch_;
  last_known_ = false;
  allowed_ = {};
  ends_[0] = stretch_.end;
  left_ = 1;
  end_ = stretch_.begin;
  next_interval();
}

void RaySearch::next_interval() {
  if (left_ == 0) {
    next_stretch();
    return;
  }
  begin_ = end_;
  end_ = ends_[--left_];
  t_ = 0.5 * (begin_ + end_);
  step_ = Step::isolate;
}

void RaySearch::answer(double value, const Point<3>& gradient) {
  gradient_ = gradient;
  const double slope = gradient.dot(ray_.direction);
  const Sample sample{t_, value, slope};
  if (last_known_ && !bounds_hold(sample)) return search_stretch();
  last_ = sample;
  last_known_ = true;
  switch (step_) {
    case Step::isolate:
      isolate(value, slope);
      break;
    case Step::refine:
      refine(value, slope);
      break;
    case Step::probe:
      leave(value);
      break;
    case Step::done:
      break;
  }
}

// Checks the bounds against an evaluation, and raises them if necessary. False if conclusions in this stretch no longer
// hold.
bool RaySearch::bounds_hold(const Sample& sample) {
  const double h = std::abs(sample.t - last_.t);
  if (h < least_distance * cells_->side()) return true;
  const double off_line = sample.value - last_.value - last_.slope * (sample.t - last_.t);
  const double bend = std::max(2 * std::abs(off_line) / h, std::abs(sample.slope - last_.slope)) / h;
  const double slope = std::max(std::abs(sample.value - last_.value) / h, std::abs(sample.slope));
  constexpr double rounding = 1 + 1e-6;  // bounds exceeded by less hold
  if (bend > rounding * stretch_.hessian_bound) stretch_.hessian_bound = raise_factor * bend;
  if (slope > rounding * stretch_.lipschitz) stretch_.lipschitz = raise_factor * slope;
  return stretch_.hessian_bound <= allowed_.hessian_bound && stretch_.lipschitz <= allowed_.lipschitz;
}

void RaySearch::accept(double t) {
  t_ = t;
  hit_ = true;
  step_ = Step::done;
}

void RaySearch::isolate(double value, double slope) {
  const double h = 0.5 * (end_ - begin_);
  const double change = std::min(stretch_.lipschitz * h, (std::abs(slope) + 0.5 * stretch_.hessian_bound * h) * h);
  if (std::abs(value) > change) {
    const double allowed = 2 * (std::abs(value) - std::abs(slope) * h) / (h * h);
    if (allowed > stretch_.hessian_bound)
      allowed_.hessian_bound = std::min(allowed_.hessian_bound, allowed);
    else
      allowed_.lipschitz = std::min(allowed_.lipschitz, std::abs(value) / h);
    leave(value);
  } else if (std::abs(slope) > stretch_.hessian_bound * h) {
    allowed_.hessian_bound = std::min(allowed_.hessian_bound, std::abs(slope) / h);
    lo_ = begin_;
    hi_ = end_;
    lo_known_ = hi_known_ = false;
    rising_ = slope > 0 ? 1 : -1;
    steps_ = 0;
    step_ = Step::refine;
    refine(value, slope);
  } else if (h <= tolerance_ || left_ == deepest) {
    step_ = Step::probe;
    t_ = end_;
  } else {
    ends_[left_++] = end_;
    end_ = t_;
    t_ = 0.5 * (begin_ + end_);
  }
}

void RaySearch::refine(double value, double slope) {
  if (value == 0) return accept(t_);
  if (rising_ * value > 0) {
    hi_ = t_;
    hi_known_ = true;
  } else {
    lo_ = t_;
    lo_known_ = true;
  }
  if (hi_ <= begin_ || lo_ >= end_) return leave(value);  // the zero is beyond the interval
  const double newton = t_ - value / slope;
  const bool usable = rising_ * slope > 0 && steps_ < most_newton_steps;
  if (usable && std::abs(newton - t_) <= tolerance_) return accept(std::clamp(newton, begin_, end_));
  const bool narrow = hi_ - lo_ <= tolerance_;
  if ((narrow && lo_known_ && hi_known_) || ++steps_ > most_steps) return accept(0.5 * (lo_ + hi_));
  if (usable && !narrow && newton > lo_ && newton < hi_) {
    t_ = newton;
  } else if (rising_ * value > 0) {
    t_ = lo_known_ ? 0.5 * (lo_ + hi_) : begin_;
  } else {
    t_ = hi_known_ ? 0.5 * (lo_ + hi_) : end_;
  }
}

// No zero was found in the interval, where f has the sign of `value`. If its sign was different before, there is one
// nevertheless: at the end of an interval, within rounding, or where estimated bounds do not hold.
void RaySearch::leave(double value) {
  const int sign = value > 0 ? 1 : -1;
  if (before_.sign == 0 || sign == before_.sign) {
    before_ = {sign, t_};
    next_interval();
    return;
  }
  lo_ = begin_ = before_.t;
  hi_ = end_ = t_;
  lo_known_ = hi_known_ = true;
  rising_ = sign;
  steps_ = most_newton_steps;
  step_ = Step::refine;
  t_ = 0.5 * (lo_ + hi_);
  if (hi_ - lo_ <= tolerance_) accept(t_);
}

}  // namespace csrbf
