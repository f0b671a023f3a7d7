#include "csrbf/surface/winding/dipole_sums.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/simd.hpp"

#include <numbers>
#include <numeric>

namespace csrbf::winding {
namespace {

constexpr float group_opening = 1.6F;  // radii from its centre beyond which a group acts as one; by hand: larger is
                                       // slower, smaller turns more normals
constexpr int group_lanes = 16;
constexpr auto inverse_four_pi = static_cast<float>(1 / (4 * std::numbers::pi));

struct Targets {
  alignas(64) float x[3][group_lanes];
  alignas(64) float half_eps2[group_lanes];
};

struct Sources {
  const float* x[3];
  const float* half_eps2;
  const float* strength;  // Inputs of the term per source
};

// Each term adds what one source gives to all targets; rx, ry, rz = p_j - p_i, s = D^(-1/2).
struct WindingTerm {
  static constexpr int inputs = 3, outputs = 1;
  static CSRBF_ALWAYS_INLINE void add(const float* m, float rx, float ry, float rz, float s, float (*sum)[group_lanes],
                                      int l) {
    sum[0][l] += (m[0] * rx + m[1] * ry + m[2] * rz) * (s * s * s);
  }
};
struct AdjointTerm {
  static constexpr int inputs = 1, outputs = 3;
  static CSRBF_ALWAYS_INLINE void add(const float* q, float rx, float ry, float rz, float s, float (*sum)[group_lanes],
                                      int l) {
    const float t = q[0] * (s * s * s);
    sum[0][l] -= t * rx;
    sum[1][l] -= t * ry;
    sum[2][l] -= t * rz;
  }
};
struct OutwardTerm {
  static constexpr int inputs = 3, outputs = 3;
  static CSRBF_ALWAYS_INLINE void add(const float* m, float rx, float ry, float rz, float s, float (*sum)[group_lanes],
                                      int l) {
    const float s2 = s * s, s3 = s2 * s, t = 3 * s2 * (m[0] * rx + m[1] * ry + m[2] * rz);
    sum[0][l] += s3 * (m[0] - t * rx);
    sum[1][l] += s3 * (m[1] - t * ry);
    sum[2][l] += s3 * (m[2] - t * rz);
  }
};

template <class Term>
CSRBF_ALWAYS_INLINE void add_all(const Sources& from, std::int32_t begin, std::int32_t end, const Targets& at,
                                 float (*__restrict sum)[group_lanes]) {
  for (std::int32_t j = begin; j < end; ++j) {
    const float px = from.x[0][j], py = from.x[1][j], pz = from.x[2][j], e2 = from.half_eps2[j];
    const float* strength = from.strength + static_cast<std::ptrdiff_t>(Term::inputs) * j;
    for (int l = 0; l < group_lanes; ++l) {
      const float rx = px - at.x[0][l], ry = py - at.x[1][l], rz = pz - at.x[2][l];
      const float s = 1 / std::sqrt(rx * rx + ry * ry + rz * rz + (e2 + at.half_eps2[l]));
      Term::add(strength, rx, ry, rz, s, sum, l);
    }
  }
}

}  // namespace

DipoleSums::DipoleSums(const PointsRef<3>& points) : order_(points.cols()) {
  std::iota(order_.begin(), order_.end(), Index{0});
  // Relative to the middle, single precision is fine enough for neighbours.
  const Box<3> box = bounding_box<3>(points);
  const Points<3> centered = points.colwise() - 0.5 * (box.lo + box.hi);
  if (!order_.empty()) build(centered, 0, std::ssize(order_));
  for (int k = 0; k < 3; ++k) {
    for (const Node& node : nodes_) x_[k].push_back(node.center[k]);
    for (const Index i : order_) x_[k].push_back(static_cast<float>(centered(k, i)));
  }
  half_eps2_.assign(x_[0].size(), 0);
  find_sources();
}

// Splits the longest side at a multiple of the block, next to the median.
std::int32_t DipoleSums::build(const Points<3>& points, Index begin, Index end) {
  const auto id = static_cast<std::int32_t>(nodes_.size());
  Box<3> box;
  Point<3> mean = Point<3>::Zero();
  for (Index i = begin; i < end; ++i) {
    box.add(Point<3>(points.col(order_[i])));
    mean += points.col(order_[i]) / static_cast<double>(end - begin);
  }
  double radius2 = 0;
  for (Index i = begin; i < end; ++i) radius2 = std::max(radius2, (points.col(order_[i]) - mean).squaredNorm());
  Node node{static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end), 0, {}, 0};
  for (int k = 0; k < 3; ++k) node.center[k] = static_cast<float>(mean[k]);
  node.radius = static_cast<float>(std::sqrt(radius2));
  nodes_.push_back(node);
  if (end - begin > block) {
    Index axis = 0;
    box.extent().maxCoeff(&axis);
    const Index middle = begin + (end - begin + block) / (2 * block) * block;
    const auto first = order_.begin();
    std::nth_element(first + begin, first + middle, first + end,
                     [&](Index a, Index b) { return std::pair(points(axis, a), a) < std::pair(points(axis, b), b); });
    build(points, begin, middle);
    nodes_[id].right = build(points, middle, end);
  }
  return id;
}

void DipoleSums::find_sources() {
  const auto count = static_cast<std::int32_t>(nodes_.size());
  std::vector<std::int32_t> stack;
  first_source_.push_back(0);
  for (const Node& target : nodes_) {
    if (target.right != 0) continue;
    const auto begin = static_cast<std::ptrdiff_t>(sources_.size());
    for (stack.assign(1, 0); !stack.empty();) {
      const std::int32_t id = stack.back();
      stack.pop_back();
      const Node& node = nodes_[id];
      float distance2 = 0;
      for (int k = 0; k < 3; ++k) distance2 += std::pow(node.center[k] - target.center[k], 2.0F);
      Range range{id, id + 1};
      if (std::sqrt(distance2) < target.radius + group_opening * node.radius) {
        if (node.right != 0) {
          stack.push_back(node.right);
          stack.push_back(id + 1);
          continue;
        }
        range = {count + node.begin, count + node.end};
      }
      if (std::ssize(sources_) > begin && sources_.back().end == range.begin)
        sources_.back().end = range.end;
      else
        sources_.push_back(range);
    }
    first_source_.push_back(static_cast<std::int32_t>(sources_.size()));
  }
}

void DipoleSums::set_smoothing(const Eigen::VectorXd& eps) {
  const std::size_t count = nodes_.size();
  for (std::size_t i = 0; i < order_.size(); ++i)
    half_eps2_[count + i] = static_cast<float>(0.5 * eps[order_[i]] * eps[order_[i]]);
  for (std::size_t n = count; n-- > 0;) {
    const Node& node = nodes_[n];
    const auto first = half_eps2_.begin() + static_cast<std::ptrdiff_t>(count);
    const auto share = static_cast<float>(node.end - node.begin);
    half_eps2_[n] = node.right == 0
                        ? std::accumulate(first + node.begin, first + node.end, 0.0F) / share
                        : (half_eps2_[n + 1] * static_cast<float>(nodes_[node.right].begin - node.begin) +
                           half_eps2_[node.right] * static_cast<float>(node.end - nodes_[node.right].begin)) /
                              share;
  }
}

template <class Term, class Strengths>
auto DipoleSums::sum(const Strengths& strengths) const {
  // Strengths of the nodes are those of their points together.
  const auto count = static_cast<Index>(nodes_.size()), n = std::ssize(order_);
  Eigen::Matrix<float, Term::inputs, Eigen::Dynamic> all(Term::inputs, count + n);
  all.rightCols(n) = strengths;
  for (Index id = count; id-- > 0;) {
    const Node& node = nodes_[id];
    if (node.right == 0)
      all.col(id) = all.middleCols(count + node.begin, node.end - node.begin).rowwise().sum();
    else
      all.col(id) = all.col(id + 1) + all.col(node.right);
  }
  const Sources from{{x_[0].data(), x_[1].data(), x_[2].data()}, half_eps2_.data(), all.data()};
  Eigen::Matrix<float, Term::outputs, Eigen::Dynamic> result(Term::outputs, n);
  parallel_for(std::ssize(first_source_) - 1, 8, [&](Index begin, Index end) {
    for (Index b = begin; b < end; ++b) {
      const Index first = b * block, size = std::min(block, n - first);
      Targets at;
      for (Index l = 0; l < block; ++l) {
        const Index from_point = count + first + std::min(l, size - 1);
        for (int k = 0; k < 3; ++k) at.x[k][l] = x_[k][from_point];
        at.half_eps2[l] = half_eps2_[from_point];
      }
      alignas(64) float total[Term::outputs][group_lanes] = {};
      for (std::int32_t s = first_source_[b]; s < first_source_[b + 1]; ++s)
        simd<add_all<Term>>(from, sources_[s].begin, sources_[s].end, at, total);
      for (Index l = 0; l < size; ++l)
        for (int k = 0; k < Term::outputs; ++k) result(k, first + l) = inverse_four_pi * total[k][l];
    }
  });
  return result;
}

Eigen::VectorXf DipoleSums::winding(const Vectors& m) const {
  return sum<WindingTerm>(m).transpose();
}

DipoleSums::Vectors DipoleSums::adjoint(const Eigen::VectorXf& r) const {
  return sum<AdjointTerm>(r.transpose());
}

DipoleSums::Vectors DipoleSums::outward(const Vectors& m) const {
  return sum<OutwardTerm>(m);
}

}  // namespace csrbf::winding
