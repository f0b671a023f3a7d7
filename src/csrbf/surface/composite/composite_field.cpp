#include "csrbf/surface/composite/composite_field.hpp"

#include "csrbf/core/taylor.hpp"

#include <type_traits>

namespace csrbf {
namespace {

// Found on ten meshes, each sampled in four ways (exact normals, none, noise, few samples), by chamfer distance,
// Hausdorff distance and topology unless noted; factors of 1.5 change little. Patches are trusted where the sum of
// their weights exceeds `trusted_weight` (chosen by hand), or `certain_weight` more where the winding number is certain
// and they do not confirm its sign: there, patches that extrapolate beyond their samples make sheets and bubbles. Where
// the mean m of the local models, in units of the radii, leaves no doubt about the sign, a sum smaller by the factor 1
// + mean_factor m^2 suffices (chosen by hand), so that the field stays a distance further away ...
constexpr double trusted_weight = 0.04;
constexpr double certain_weight = 0.6;
constexpr double mean_factor = 20;
// ... where m does not contradict a certain winding number: up to `conflict` it may, above `full_conflict` the patches
// are not trusted at all ...
constexpr double conflict = 0.1;
constexpr double full_conflict = 0.2;
// ... and where the variance of the local models, in the same units, is below `agree`. Above `contradict` they are not
// trusted at all. Larger: thin parts may get spurious sheets; smaller: the winding number shows through on noisy data.
constexpr double agree = 0.005;
constexpr double contradict = 0.02;
// The winding number w is certain where |u|, u = 2w - 1, exceeds `decided`: it gives the sign where patches are not
// trusted. Below `undecided`, coarser patches complete the surface instead. Both chosen by hand.
constexpr double undecided = 0.2;
constexpr double decided = 0.45;
// Of the feature size: values nearer to 0 say little about the side. Chosen on 30 meshes, each sampled in up to
// thirteen ways; larger: true handles go, smaller: false ones stay.
constexpr double doubtful_share = 0.2;
constexpr double doubtful_share_of_noise = 0.3;
constexpr double chunk_reach = 4;  // diagonal of a chunk, in units of the far value; larger: more patches to search

// A value with the derivatives requested.
template <Derivatives derivatives>
using ScalarWith = std::conditional_t<derivatives == Derivatives::none, double,
                                      Taylor<3, derivatives == Derivatives::hessian ? 2 : 1>>;

template <class Scalar>
constexpr bool has_gradient = !std::is_same_v<Scalar, double>;
template <class Scalar>
constexpr bool has_hessian = std::is_same_v<Scalar, Taylor<3, 2>>;

// One lane of one of the sums.
template <class Scalar>
Scalar load(const double (*terms)[PatchSums::lanes], int lane) {
  Scalar t(terms[0][lane]);
  if constexpr (has_gradient<Scalar>)
    for (int c = 0; c < 3; ++c) t.gradient[c] = terms[1 + c][lane];
  if constexpr (has_hessian<Scalar>)
    for (int c = 0, term = 4; c < 3; ++c)
      for (int d = c; d < 3; ++d, ++term) t.hessian(c, d) = t.hessian(d, c) = terms[term][lane];
  return t;
}

template <class Scalar>
double value_of(const Scalar& x) {
  if constexpr (has_gradient<Scalar>)
    return x.value;
  else
    return x;
}

template <class Scalar>
void store(const Scalar& f, int i, double scale, const JetBlock& out) {
  out.value[i] = scale * value_of(f);
  if constexpr (has_gradient<Scalar>)
    for (int c = 0; c < 3; ++c) out.gradient[3 * i + c] = f.gradient[c];
  if constexpr (has_hessian<Scalar>)
    for (int c = 0, term = 0; c < 3; ++c)
      for (int d = c; d < 3; ++d, ++term) out.hessian[6 * i + term] = f.hessian(c, d) / scale;
}

// Sum over levels, each weighted by a share of the weight that the finer ones left open.
template <class Scalar>
struct Cascade {
  Scalar sum = Scalar(0.0);
  Scalar open = Scalar(1.0);
};

// Points of a chunk at which the finest patches alone are not trusted.
struct Pending {
  Index count = 0;
  std::array<int, PatchSums::lanes> lane;
  Eigen::Matrix<double, 3, PatchSums::lanes> points;

  void add(int l, const Point<3>& x) {
    lane[count] = l;
    points.col(count++) = x;
  }
};

// The winding number at a point, as u = 2w - 1.
template <class Scalar>
struct Winding {
  Scalar u = Scalar(0.0);
  Scalar certainty = Scalar(0.0);  // in [0, 1]

  [[nodiscard]] double sign() const { return value_of(u) < 0 ? -1 : 1; }
};

// Weight of one level at a point, in [0, 1].
template <class Scalar>
Scalar trust(const PatchSums& sums, int lane, const Winding<Scalar>& winding) {
  const auto power = [&](const Scalar& x) { return sums.sharp ? Scalar(x * x * x) : x; };
  const Scalar W = load<Scalar>(sums.W, lane);
  if (value_of(W) <= 0) return Scalar(0.0);
  const Scalar mean = load<Scalar>(sums.A, lane) / W;
  const Scalar variance = load<Scalar>(sums.Q, lane) / W - mean * mean;
  if (value_of(variance) >= contradict) return Scalar(0.0);
  const Scalar right = winding.sign() * mean, wrong = (-1.0) * right;
  const Scalar doubt = value_of(right) < conflict ? 1.0 - smooth_step((1 / conflict) * right) : Scalar(0.0);
  Scalar result = smooth_step(W * power(1.0 + mean_factor * (mean * mean)) /
                              power(trusted_weight + certain_weight * (winding.certainty * doubt)));
  if (value_of(wrong) > conflict)
    result = result * (1.0 - winding.certainty * smooth_step((1 / (full_conflict - conflict)) * (wrong - conflict)));
  if (value_of(variance) > agree)
    result = result * (1.0 - smooth_step((1 / (contradict - agree)) * (variance - agree)));
  return result;
}

// Whether the finest patches are trusted entirely whatever the winding number: trust() = 1.
bool sure(const PatchSums& sums, int lane) {
  const double W = sums.W[0][lane];
  if (!(W > 0)) return false;
  const double mean = sums.A[0][lane] / W;
  return W >= trusted_weight + certain_weight && std::abs(mean) <= conflict &&
         sums.Q[0][lane] / W - mean * mean <= agree;
}

// The blended model F = S / W of a level.
void store_blend(const PatchSums& sums, int i, double scale, const JetBlock& out) {
  const double inverse = 1 / sums.W[0][i], F = sums.S[0][i] * inverse;
  out.value[i] = scale * F;
  if (out.gradient == nullptr) return;
  std::array<double, 4> W, D;  // derivatives of W and F
  for (std::size_t c = 1; c < 4; ++c) {
    W[c] = sums.W[c][i];
    D[c] = (sums.S[c][i] - F * W[c]) * inverse;
    out.gradient[3 * i + static_cast<int>(c) - 1] = D[c];
  }
  if (out.hessian == nullptr) return;
  for (std::size_t c = 1, term = 4; c < 4; ++c)
    for (std::size_t d = c; d < 4; ++d, ++term)
      out.hessian[6 * i + static_cast<int>(term) - 4] =
          (sums.S[term][i] - F * sums.W[term][i] - D[c] * W[d] - D[d] * W[c]) * inverse / scale;
}

// 0 where u is undecided, 1 where it is certain.
template <class Scalar>
Scalar certainty_of(const Scalar& u) {
  const double magnitude = std::abs(value_of(u));
  if (magnitude <= undecided) return Scalar(0.0);
  if (magnitude >= decided) return Scalar(1.0);
  const double sign = value_of(u) < 0 ? -1 : 1;
  return smooth_step((1 / (decided - undecided)) * (sign * u - undecided));
}

template <class Scalar>
std::array<Winding<Scalar>, PatchSums::lanes> evaluate(const CompositeField::Data& data, const Pending& pending) {
  std::array<Winding<Scalar>, PatchSums::lanes> result;
  std::array<double, PatchSums::lanes> value{};
  std::array<double, 3 * PatchSums::lanes> gradient{};
  std::array<double, 6 * PatchSums::lanes> hessian{};
  data.winding.evaluate_block(
      pending.points.leftCols(pending.count),
      {value.data(), has_gradient<Scalar> ? gradient.data() : nullptr, has_hessian<Scalar> ? hessian.data() : nullptr});
  for (Index p = 0; p < pending.count; ++p) {
    Scalar& u = result[p].u;
    u = Scalar(value[p] - data.winding_level);
    if constexpr (has_gradient<Scalar>)
      for (int c = 0; c < 3; ++c) u.gradient[c] = gradient[3 * p + c];
    if constexpr (has_hessian<Scalar>)
      for (int c = 0, term = 0; c < 3; ++c)
        for (int d = c; d < 3; ++d, ++term) u.hessian(c, d) = u.hessian(d, c) = hessian[6 * p + term];
    result[p].certainty = certainty_of(u);
  }
  return result;
}

// Adds one level to the sum t_0 f_0 + (1 - t_0) ( t_1 f_1 + (1 - t_1) ( ... ) ), finest first.
template <class Scalar>
void add_level(Cascade<Scalar>& cascade, const PatchSums& sums, int lane, const Winding<Scalar>& winding,
               const Scalar& share = Scalar(1.0)) {
  const Scalar trusted = share * trust(sums, lane, winding);
  if (value_of(trusted) <= 0) return;
  const Scalar f = load<Scalar>(sums.S, lane) / load<Scalar>(sums.W, lane);
  cascade.sum = cascade.sum + cascade.open * trusted * f;
  cascade.open = cascade.open * (1.0 - trusted);
}

// How far patches cover a point, in [0, 1]: where they hardly do, the nearest ones extrapolate, too.
template <class Scalar>
Scalar covered(const PatchSums& sums, int lane) {
  return smooth_step((1 / (trusted_weight + certain_weight)) * load<Scalar>(sums.W, lane));
}

// F = t f_0 + (1 - t) ( (1 - c) C + c far_value u ): the finest patches where they are trusted (t), else the winding
// number where it is certain (c), else the cascade C: of the finest patches with sharper weights (where a thin part
// leaves a body, the nearest ones are right, and those of the body are not), and of the coarser levels.
template <Derivatives derivatives>
void complete(const CompositeField::Data& data, const PatchSums& finest, const Pending& pending,
              const std::array<Winding<ScalarWith<derivatives>>, PatchSums::lanes>& winding, const JetBlock& out) {
  using Scalar = ScalarWith<derivatives>;
  std::array<Cascade<Scalar>, PatchSums::lanes> cascade;
  for (std::size_t level = 0; level < data.levels.size(); ++level) {
    Pending asking;
    for (Index p = 0; p < pending.count; ++p)
      if (value_of(winding[p].certainty) < 1 && value_of(cascade[p].open) > 0)
        asking.add(static_cast<int>(p), pending.points.col(p));
    if (asking.count == 0) break;
    PatchSums sums;
    sums.sharp = level == 0;
    data.levels[level].accumulate(asking.points.leftCols(asking.count), derivatives, sums);
    for (int i = 0; i < asking.count; ++i) {
      const int p = asking.lane[i];
      const Scalar share = sums.sharp ? covered<Scalar>(finest, pending.lane[p]) : Scalar(1.0);
      add_level(cascade[p], sums, i, winding[p], share);
    }
  }
  for (Index p = 0; p < pending.count; ++p) {
    Cascade<Scalar> sure;
    add_level(sure, finest, pending.lane[p], winding[p]);
    const Scalar far = data.far_value * winding[p].u;
    const Scalar& certainty = winding[p].certainty;
    const Scalar rest = (1.0 - certainty) * (cascade[p].sum + cascade[p].open * far) + certainty * far;
    store(Scalar(sure.sum + sure.open * rest), pending.lane[p], data.scale, out);
  }
}

template <Derivatives derivatives>
void blend_levels(const CompositeField::Data& data, const PointsRef<3>& y, const JetBlock& out) {
  PatchSums finest;
  data.levels.front().accumulate(y, derivatives, finest);
  Pending doubtful;
  for (int lane = 0; lane < static_cast<int>(y.cols()); ++lane) {
    if (sure(finest, lane)) {
      store_blend(finest, lane, data.scale, out);
    } else {
      doubtful.add(lane, y.col(lane));
    }
  }
  if (doubtful.count == 0) return;
  // The winding number takes most doubts away; its derivatives do not count then.
  const std::array<Winding<double>, PatchSums::lanes> winding = evaluate<double>(data, doubtful);
  Pending open;
  std::array<Winding<double>, PatchSums::lanes> winding_of_open;
  for (Index p = 0; p < doubtful.count; ++p) {
    const int lane = doubtful.lane[p];
    if (trust<double>(finest, lane, winding[p]) >= 1) {
      store_blend(finest, lane, data.scale, out);
    } else {
      winding_of_open[open.count] = winding[p];
      open.add(lane, doubtful.points.col(p));
    }
  }
  if (open.count == 0) return;
  if constexpr (derivatives == Derivatives::none)
    complete<derivatives>(data, finest, open, winding_of_open, out);
  else
    complete<derivatives>(data, finest, open, evaluate<ScalarWith<derivatives>>(data, open), out);
}

}  // namespace

// Parts thinner than the spacing are as thick as two features: values between their sheets are up to one.
double CompositeField::least_persistence() const {
  const double spacing = data_.far_value / far_spacings;
  const double detail = std::min(std::max(data_.feature_size, spacing), 3 * data_.feature_size);
  return (data_.noisy ? doubtful_share_of_noise : doubtful_share) * data_.scale * detail;
}

Points<3> CompositeField::seeds() const {
  const std::vector<Patch>& patches = data_.levels.front().patches();
  Points<3> seeds(3, std::ssize(patches));
  for (Index i = 0; i < seeds.cols(); ++i) seeds.col(i) = data_.origin + data_.scale * patches[i].center;
  return seeds;
}

// Points of a chunk share the search for patches: it ends before the next point makes it wider than a few patches.
void CompositeField::evaluate_block(const PointsRef<3>& x, const JetBlock& out) const {
  const auto blend = out.derivatives() == Derivatives::none       ? blend_levels<Derivatives::none>
                     : out.derivatives() == Derivatives::gradient ? blend_levels<Derivatives::gradient>
                                                                  : blend_levels<Derivatives::hessian>;
  const double widest = chunk_reach * data_.far_value;
  Points<3> y(3, PatchSums::lanes);
  for (Index begin = 0; begin < x.cols();) {
    Box<3> box;
    Index count = 0;
    for (; count < PatchSums::lanes && begin + count < x.cols(); ++count) {
      y.col(count) = (x.col(begin + count) - data_.origin) / data_.scale;
      Box<3> grown = box;
      grown.add(Point<3>(y.col(count)));
      if (count > 0 && !(grown.diagonal() <= widest)) break;
      box = grown;
    }
    blend(data_, y.leftCols(count), out.from<3>(begin));
    begin += count;
  }
}

}  // namespace csrbf
