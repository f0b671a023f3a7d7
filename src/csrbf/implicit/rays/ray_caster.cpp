#include "csrbf/implicit/rays/ray_caster.hpp"

#include "csrbf/implicit/polygonize.hpp"

namespace csrbf {
namespace {

constexpr int largest_resolution = 1024;      // cells along the longest side: bounds memory
constexpr double relative_tolerance = 1e-13;  // of hits, in diagonals of the bounds: close to rounding
constexpr std::size_t rays_together = 256;    // evaluated in one block
// Chosen by hand.
constexpr int most_newton_steps = 8;     // then bisection
constexpr int most_steps = 80;           // of both: more than bisection of a double needs
constexpr double raise_factor = 1.5;     // of a raised bound over the derivative found; larger: fewer revisions, slower
constexpr double least_distance = 1e-3;  // cells: second derivatives from closer evaluations are rounding

// The search for the first zero of a field along a ray, one evaluation at a time, so that many rays can be evaluated
// together: while not done(), call answer() with the value and the gradient at query().
//
// In an interval of half-length h around m, with |f''| <= G and |f'| <= L along the ray, there is no zero if |f(m)| >
// min(L h, |f'(m)| h + G h^2 / 2) (interval refinement; Mitchell 1990, with Taylor's formula as the inclusion), and f
// is monotone if |f'(m)| > G h (Kalra, Barr 1989). Otherwise the interval is halved, the near half first. In a
// monotone interval the zero, if there is one, is bracketed and found by Newton's method. Intervals that cannot be
// divided further contain a zero if f changes sign. Estimated bounds are checked against each evaluation and the
// previous one; if they are too small they are raised, and conclusions that they invalidate are revised.
class RaySearch {
 public:
  // `tolerance`: of the distance along the ray; > 0.
  RaySearch(const CandidateCells& cells, const Ray& ray, double t_max, double tolerance)
      : cells_(&cells), ray_(ray), t_max_(t_max), tolerance_(tolerance) {
    next_stretch();
  }

  [[nodiscard]] bool done() const { return step_ == Step::done; }
  [[nodiscard]] Point<3> query() const { return ray_.origin + t_ * ray_.direction; }

  // Once done: whether there is a zero, and where.
  [[nodiscard]] bool hit() const { return hit_; }
  [[nodiscard]] double t() const { return t_; }
  // The last gradient: that at the zero, up to the tolerance.
  [[nodiscard]] const Point<3>& gradient() const { return gradient_; }

  void answer(double value, const Point<3>& gradient) {
    gradient_ = gradient;
    const double slope = gradient.dot(ray_.direction);
    const Sample sample{t_, value, slope};
    if (last_known_ && !bounds_hold(sample)) return search_stretch();
    last_ = sample;
    last_known_ = true;
    if (step_ == Step::isolate) {
      isolate(value, slope);
    } else if (step_ == Step::refine) {
      refine(value, slope);
    } else if (step_ == Step::probe) {
      leave(value);
    }
  }

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

  void next_stretch() {
    if (!cells_->next(ray_, t_max_, walk_, stretch_)) {
      step_ = Step::done;
      return;
    }
    before_stretch_ = before_;
    search_stretch();
  }

  void search_stretch() {
    before_ = before_stretch_;
    last_known_ = false;
    allowed_ = {};
    ends_[0] = stretch_.end;
    left_ = 1;
    end_ = stretch_.begin;
    next_interval();
  }

  void next_interval() {
    if (left_ == 0) return next_stretch();
    begin_ = end_;
    end_ = ends_[--left_];
    t_ = 0.5 * (begin_ + end_);
    step_ = Step::isolate;
  }

  // Checks the bounds against an evaluation, and raises them if necessary. False if conclusions in this stretch no
  // longer hold.
  bool bounds_hold(const Sample& sample) {
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

  void accept(double t) {
    t_ = t;
    hit_ = true;
    step_ = Step::done;
  }

  void isolate(double value, double slope) {
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

  void refine(double value, double slope) {
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
  void leave(double value) {
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
  double begin_ = 0, end_ = 0;     // the interval
  Known before_, before_stretch_;  // the interval, the stretch
  Sample last_;
  Allowed allowed_;
  bool last_known_ = false;  // in this stretch

  double lo_ = 0, hi_ = 0;  // bracket of a zero
  bool lo_known_ = false, hi_known_ = false;
  int rising_ = 1, steps_ = 0;
};

int checked_resolution(int resolution) {
  require(resolution >= 4 && resolution <= largest_resolution, "raycast", "resolution", resolution,
          "must be in [4, 1024]");
  return resolution;
}

// Empty for fields that have no surface or need no mesh.
Mesh mesh_for(const Field<3>& field, int resolution, const Progress& progress) {
  if (field.enclose(field.bounds())) return {};
  try {
    return polygonize(field, {.resolution = checked_resolution(resolution), .normals = false, .progress = progress});
  } catch (const SolverFailure&) {
    return {};
  }
}

}  // namespace

RayCaster::RayCaster(const Field<3>& field, int resolution, const Progress& progress)
    : RayCaster(field, resolution, mesh_for(field, resolution, progress), progress) {}

RayCaster::RayCaster(const Field<3>& field, int resolution, const Mesh& mesh, const Progress& progress)
    : field_(field),
      cells_(field, static_cast<int>(checked_resolution(resolution) / CandidateCells::finer), mesh, progress),
      tolerance_(relative_tolerance * field.bounds().diagonal()) {}

void RayCaster::cast(std::span<const Ray> rays, double t_max, std::span<RayHit> hits) const {
  std::vector<RaySearch> searches;
  searches.reserve(rays_together);
  std::vector<std::size_t> open;
  Points<3> x(3, rays_together), gradient(3, rays_together);
  Eigen::VectorXd value(rays_together);
  for (std::size_t first = 0; first < rays.size(); first += rays_together) {
    const std::size_t count = std::min(rays_together, rays.size() - first);
    searches.clear();
    open.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const Ray& ray = rays[first + i];
      const double far = ray.origin.cwiseAbs().maxCoeff();  // rounding of positions on the ray
      searches.emplace_back(cells_, ray, t_max, std::max(tolerance_, 1e-15 * far));
      if (!searches.back().done()) open.push_back(i);
    }
    while (!open.empty()) {
      const auto n = std::ssize(open);
      for (Index k = 0; k < n; ++k) x.col(k) = searches[open[k]].query();
      field_.evaluate_block(x.leftCols(n), {value.data(), gradient.data(), nullptr});
      for (Index k = 0; k < n; ++k) searches[open[k]].answer(value[k], gradient.col(k));
      std::erase_if(open, [&](std::size_t i) { return searches[i].done(); });
    }
    for (std::size_t i = 0; i < count; ++i) {
      hits[first + i] = RayHit{};
      if (searches[i].hit()) hits[first + i] = {searches[i].t(), -searches[i].gradient().normalized()};
    }
  }
}

}  // namespace csrbf
