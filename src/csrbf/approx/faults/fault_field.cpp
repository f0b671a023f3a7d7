#include "csrbf/approx/faults/fault_field.hpp"

#include "csrbf/approx/kriging/local_kriging.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace csrbf {
namespace {

constexpr int lanes = LocalModels<2>::lanes;
constexpr int terms = LocalEvaluator<2>::terms;  // value, gradient, upper triangle of the Hessian
constexpr Index looked_at = 64;                  // anchors, nearest first, where no disc reaches

using Terms = std::array<double, static_cast<std::size_t>(terms)>;

// The jet of w = (1 - s)^4, s = (d^2 / (|x - anchor| R))^2 for d = offset + |x - corner|; zeros outside. Where x sees
// the anchor, d = |x - anchor|.
Terms weight(const Point<2>& x, const Point<2>& anchor, const Sight& sight, double R) {
  const Eigen::Matrix2d I = Eigen::Matrix2d::Identity();
  const Point<2> y = x - anchor, z = x - sight.corner;
  const double e2 = y.squaredNorm(), r = z.norm(), d = sight.offset + r;
  double square = e2 / (R * R);
  Point<2> s = 2 / (R * R) * y;
  Eigen::Matrix2d H = 2 / (R * R) * I;
  if (sight.offset > 0 && e2 > 0) {
    // By the derivatives of log s = 4 log d - 2 log |x - anchor| - 2 log R.
    const Point<2> u = r > 0 ? Point<2>(z / r) : Point<2>(Point<2>::Zero()), v = y / e2;
    const Eigen::Matrix2d uu = u * u.transpose();
    square = d * d * d * d / (e2 * R * R);
    const Point<2> slope = 4 / d * u - 2 * v;
    const Eigen::Matrix2d bend =
        4 * ((I - uu) / (std::max(r, 1e-300) * d) - uu / (d * d)) - 2 * (I / e2 - 2 * v * v.transpose());
    s = square * slope;
    H = square * (slope * slope.transpose() + bend);
  }
  const double rest = 1 - square;
  if (!(rest > 0)) return {};
  const double w3 = rest * rest * rest;
  Terms w = {w3 * rest, -4 * w3 * s[0], -4 * w3 * s[1]};
  w[3] = 12 * rest * rest * s[0] * s[0] - 4 * w3 * H(0, 0);
  w[4] = 12 * rest * rest * s[0] * s[1] - 4 * w3 * H(0, 1);
  w[5] = 12 * rest * rest * s[1] * s[1] - 4 * w3 * H(1, 1);
  return w;
}

Terms product(const Terms& a, const Terms& b) {
  return {a[0] * b[0],
          a[1] * b[0] + a[0] * b[1],
          a[2] * b[0] + a[0] * b[2],
          a[3] * b[0] + 2 * a[1] * b[1] + a[0] * b[3],
          a[4] * b[0] + a[1] * b[2] + a[2] * b[1] + a[0] * b[4],
          a[5] * b[0] + 2 * a[2] * b[2] + a[0] * b[5]};
}

Terms inverse(const Terms& a) {
  const double i = 1 / a[0], i2 = i * i, i3 = i2 * i;
  return {i,
          -i2 * a[1],
          -i2 * a[2],
          2 * i3 * a[1] * a[1] - i2 * a[3],
          2 * i3 * a[1] * a[2] - i2 * a[4],
          2 * i3 * a[2] * a[2] - i2 * a[5]};
}

void add(Terms& sum, const Terms& a) {
  for (std::size_t t = 0; t < sum.size(); ++t) sum[t] += a[t];
}

// A point that a patch counts at.
struct Visit {
  Index point;
  Terms weight;
};

// The patches that count at points, with their weights.
std::map<Index, std::vector<Visit>> find_visits(const FaultField::Data& data, const PointsRef<2>& x) {
  std::map<Index, std::vector<Visit>> visits;
  std::vector<Index> near;
  for (Index i = 0; i < x.cols(); ++i) {
    const Point<2> p = x.col(i);
    if (!p.allFinite()) continue;
    bool any = false;
    for (const auto& one : data.classes) {
      one->tree->within(p, one->radius, near);
      for (const Index k : near) {
        const Index patch = one->patches[static_cast<std::size_t>(k)];
        const auto& nearby = data.nearby[static_cast<std::size_t>(patch)];
        const Sight sight = data.faults.sight(data.anchors.col(patch), p, nearby);
        if (!sight.seen) continue;
        const Terms w = weight(p, data.anchors.col(patch), sight, data.radii[patch]);
        if (!(w[0] > 0)) continue;
        any = true;
        visits[patch].push_back({i, w});
      }
    }
    if (any) continue;
    // No disc reaches: the nearest anchor that is seen, else the nearest.
    double best = std::numeric_limits<double>::infinity();
    Index chosen = -1;
    for (const bool seen : {true, false}) {
      if (chosen >= 0) break;
      for (const auto& one : data.classes) {
        std::array<Index, looked_at> found;
        std::array<double, looked_at> d2;
        const Index count = one->tree->nearest(p, looked_at, found.data(), d2.data());
        for (Index k = 0; k < count; ++k) {
          const auto slot = static_cast<std::size_t>(k);
          const Index patch = one->patches[static_cast<std::size_t>(found[slot])];
          if (!(d2[slot] < best)) break;
          if (seen && !data.faults
                           .sight(data.anchors.col(patch), p,
                                  data.faults.within(data.anchors.col(patch), std::sqrt(d2[slot]) * (1 + 1e-9)))
                           .seen)
            continue;
          best = d2[slot];
          chosen = patch;
        }
      }
    }
    visits[chosen].push_back({i, Terms{1}});
  }
  return visits;
}

// The variance of a patch, which its samples are gathered for and their matrix factorised.
class PatchVariance {
 public:
  PatchVariance(const FaultField::Data& data, Index patch)
      : covariance_{.kernel = data.models.kernel,
                    .length = data.models.radius[patch],
                    .nugget = data.prediction->nugget,
                    .degree = data.models.degree,
                    .sigma2 = data.prediction->sigma2},
        scales_(data.variances.col(patch)) {
    const auto weights = data.prediction->weights.col(patch);
    const Index M = data.models.centers_each, n = (weights.array() > 0).count();
    const Point<2> center = data.models.center.col(patch);
    const Eigen::Map<const Points<2>> q(data.models.position.data() + 2 * M * patch, 2, n);
    const Samples<2> samples{(covariance_.length * q).colwise() + center,
                             Eigen::MatrixXd::Zero(n, data.models.components), weights.head(n)};
    std::vector<Index> all(static_cast<std::size_t>(n));
    std::iota(all.begin(), all.end(), Index{0});
    patch_.emplace(samples, covariance_, center, all);
  }

  [[nodiscard]] double at(const Point<2>& x, Index component) const {
    return prediction_variance(covariance_, component, patch_->share(x), scales_[component]);
  }

 private:
  Covariance covariance_;
  Eigen::VectorXd scales_;
  std::optional<KrigingPatch<2>> patch_;
};

}  // namespace

FaultField::Data::Data(FaultLines given, Points<2> places, Eigen::VectorXd sizes, LocalModels<2> functions,
                       Eigen::MatrixXd deviations, const Box<2>& around, std::optional<Prediction> predicted)
    : faults(std::move(given)),
      anchors(std::move(places)),
      radii(std::move(sizes)),
      models(std::move(functions)),
      variances(std::move(deviations)),
      box(around),
      prediction(std::move(predicted)) {
  require(anchors.cols() > 0 && radii.size() == anchors.cols() && models.size() == anchors.cols() &&
              variances.cols() == anchors.cols() && radii.minCoeff() > 0 &&
              (!prediction ||
               (prediction->weights.rows() == models.centers_each && prediction->weights.cols() == anchors.cols() &&
                prediction->sigma2.size() == models.components)),
          "FaultField", "patches", anchors.cols(), "the parts do not fit");
  std::map<int, std::vector<Index>> octaves;
  for (Index k = 0; k < anchors.cols(); ++k) {
    octaves[std::ilogb(radii[k])].push_back(k);
    nearby.push_back(faults.within(anchors.col(k), radii[k]));
  }
  for (auto& [octave, patches] : octaves) {
    auto one = std::make_unique<Data::SizeClass>();
    one->radius = radii(patches).maxCoeff();
    one->anchors = anchors(Eigen::all, patches);
    one->patches = std::move(patches);
    one->tree = std::make_unique<const KdTree<2>>(one->anchors);
    classes.push_back(std::move(one));
  }
}

void FaultField::evaluate_block(const PointsRef<2>& x, const JetBlock& out) const {
  const Data& data = *data_;
  const Derivatives derivatives = out.derivatives();
  const auto n = static_cast<std::size_t>(x.cols());
  std::vector<Terms> sums(n, Terms{}), weights(n, Terms{});
  LocalEvaluator<2> evaluator(data.models);
  alignas(64) double at[2 * lanes];
  alignas(64) double f[terms][lanes] = {};
  for (const auto& [patch, visits] : find_visits(data, x)) {
    std::optional<PatchVariance> variance;
    if (is_variance_ && data.prediction) variance.emplace(data, patch);
    for (std::size_t first = 0; first < visits.size(); first += lanes) {
      const std::size_t used = std::min<std::size_t>(lanes, visits.size() - first);
      if (!is_variance_) {
        for (std::size_t l = 0; l < lanes; ++l)
          for (Index a = 0; a < 2; ++a)
            at[lanes * a + static_cast<Index>(l)] = x(a, visits[first + std::min(l, used - 1)].point);
        evaluator.evaluate(patch, component_, at, derivatives, f);
      }
      for (std::size_t l = 0; l < used; ++l) {
        const Visit& visit = visits[first + l];
        Terms jet = {};
        if (is_variance_)
          jet[0] = variance ? variance->at(x.col(visit.point), component_) : data.variances(component_, patch);
        else
          for (std::size_t t = 0; t < jet.size(); ++t) jet[t] = f[t][l];
        add(sums[static_cast<std::size_t>(visit.point)], product(visit.weight, jet));
        add(weights[static_cast<std::size_t>(visit.point)], visit.weight);
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Terms jet = product(sums[i], inverse(weights[i]));  // NaN where x is
    out.value[i] = jet[0];
    if (is_variance_) {  // derivatives are not provided
      constexpr double nan = std::numeric_limits<double>::quiet_NaN();
      if (out.gradient != nullptr) std::fill_n(out.gradient + 2 * i, 2, nan);
      if (out.hessian != nullptr) std::fill_n(out.hessian + 3 * i, 3, nan);
      continue;
    }
    if (out.gradient != nullptr) std::copy_n(jet.data() + 1, 2, out.gradient + 2 * i);
    if (out.hessian != nullptr) std::copy_n(jet.data() + 3, 3, out.hessian + 3 * i);
  }
}

std::vector<Index> FaultField::evaluation_order(const PointsRef<2>& x) const {
  return rough_morton_order<2>(x);
}

}  // namespace csrbf
