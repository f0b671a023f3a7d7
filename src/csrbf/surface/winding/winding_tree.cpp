#include "csrbf/surface/winding/winding_tree.hpp"

#include "csrbf/core/interruption.hpp"

#include <memory>
#include <numbers>
#include <tuple>
#include <utility>

namespace csrbf::winding {
namespace {

using Linear = std::array<double, 3>;
using Quadratic = std::array<double, 6>;  // xx xy xz yy yz zz
using Cubic = std::array<double, 10>;     // xxx xxy xxz xyy xyz xzz yyy yyz yzz zzz

constexpr std::size_t leaf_size = 12;   // samples at most; chosen by hand. Larger: fewer nodes, more exact sums
constexpr int max_midpoint_depth = 64;  // below, nodes are split by rank: bounds the depth for clustered samples
constexpr double two_pi = 2 * std::numbers::pi;

Quadratic multiply(const Linear& a, const Linear& b) {
  return {a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[2] * b[0],
          a[1] * b[1], a[1] * b[2] + a[2] * b[1], a[2] * b[2]};
}

Cubic multiply(const Quadratic& a, const Linear& b) {
  return {a[0] * b[0],
          a[0] * b[1] + a[1] * b[0],
          a[0] * b[2] + a[2] * b[0],
          a[1] * b[1] + a[3] * b[0],
          a[1] * b[2] + a[2] * b[1] + a[4] * b[0],
          a[2] * b[2] + a[5] * b[0],
          a[3] * b[1],
          a[3] * b[2] + a[4] * b[1],
          a[4] * b[2] + a[5] * b[1],
          a[5] * b[2]};
}

template <std::size_t Size>
void add(std::array<double, Size>& sum, double factor, const std::array<double, Size>& term) {
  for (std::size_t k = 0; k < Size; ++k) sum[k] += factor * term[k];
}

// Moments about a centre c as polynomials of r: N = sum m.r, M = sum (m.r)(d.r), Q = sum (m.r)(d.r)^2, where m = a n /
// 2 pi and d = p - c; centre and eps^2 are means with weight |m|.
struct Moments {
  double weight = 0;
  Linear center{};
  double eps2 = 0;
  Linear N{};
  Quadratic M{};
  Cubic Q{};
};

// Adds moments about another centre: d = d' + t.
void add_shifted(Moments& sum, const Moments& part) {
  Linear t;
  for (std::size_t k = 0; k < 3; ++k) t[k] = part.center[k] - sum.center[k];
  const Quadratic Nt = multiply(part.N, t);
  add(sum.N, 1, part.N);
  add(sum.M, 1, part.M);
  add(sum.M, 1, Nt);
  add(sum.Q, 1, part.Q);
  add(sum.Q, 2, multiply(part.M, t));
  add(sum.Q, 1, multiply(Nt, t));
}

// A sample while the tree is built, lengths in units of the tree.
struct Item {
  double p[3];
  float m[3];
  float eps2;
  std::int64_t index;
};

class Builder {
 public:
  explicit Builder(std::vector<Item> items) : items_(std::move(items)), buffer_(new Item[items_.size()]) {
    nodes_.reserve(items_.size() / 2 + 1);
    build(0, items_.size(), 0);
  }
  /// The items in the order of the tree, and its nodes.
  std::pair<std::vector<Item>, std::vector<Node>> take() && { return {std::move(items_), std::move(nodes_)}; }

 private:
  Moments build(std::size_t begin, std::size_t end, int depth) {
    pause_();
    const std::size_t id = nodes_.size();
    nodes_.emplace_back();
    Moments moments;
    std::int32_t right_child = 0;
    if (end - begin <= leaf_size) {
      moments = sum_leaf(begin, end);
    } else {
      const std::size_t middle = split(begin, end, depth);
      const Moments left = build(begin, middle, depth + 1);
      right_child = static_cast<std::int32_t>(nodes_.size());
      const Moments right = build(middle, end, depth + 1);
      moments = combine(left, right);
    }
    Node& node = nodes_[id];
    node.right = right_child;
    node.begin = static_cast<std::int32_t>(begin);
    node.count = static_cast<std::int32_t>(end - begin);
    finish(node, moments);
    return moments;
  }

  // Splits the longest side in the middle, or by rank where samples coincide or the tree gets too deep.
  std::size_t split(std::size_t begin, std::size_t end, int depth) {
    Box<3> box;
    for (std::size_t i = begin; i < end; ++i) box.add(Point<3>(items_[i].p));
    Index axis = 0;
    box.extent().maxCoeff(&axis);
    const double middle = 0.5 * (box.lo[axis] + box.hi[axis]);
    if (depth < max_midpoint_depth && box.lo[axis] < middle) return partition(begin, end, axis, middle);
    const auto first = items_.begin();
    std::stable_sort(first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(end),
                     [axis](const Item& a, const Item& b) { return a.p[axis] < b.p[axis]; });
    return begin + (end - begin) / 2;
  }

  // Moves samples that are not left of `middle` to the end; both parts keep their order. Branchless.
  std::size_t partition(std::size_t begin, std::size_t end, Index axis, double middle) {
    std::size_t left = begin, right = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Item item = items_[i];
      const bool is_left = item.p[axis] < middle;
      items_[left] = item;
      buffer_[right] = item;
      left += is_left ? 1 : 0;
      right += is_left ? 0 : 1;
    }
    std::copy_n(buffer_.get(), right, items_.begin() + static_cast<std::ptrdiff_t>(left));
    return left;
  }

  [[nodiscard]] Moments sum_leaf(std::size_t begin, std::size_t end) const {
    std::array<Moments, leaf_size> samples;
    double weight = 0;
    for (std::size_t i = begin; i < end; ++i) {
      Moments& sample = samples[i - begin];
      const Item& item = items_[i];
      for (std::size_t k = 0; k < 3; ++k) {
        sample.center[k] = item.p[k];
        sample.N[k] = item.m[k];
      }
      sample.eps2 = item.eps2;
      sample.weight = std::hypot(sample.N[0], sample.N[1], sample.N[2]);
      weight += sample.weight;
    }
    // Samples of zero weight still have a position.
    const std::size_t count = end - begin;
    Moments sum;
    sum.weight = weight;
    for (std::size_t i = 0; i < count; ++i) {
      const double share = weight > 0 ? samples[i].weight / weight : 1 / static_cast<double>(count);
      add(sum.center, share, samples[i].center);
      sum.eps2 += share * samples[i].eps2;
    }
    for (std::size_t i = 0; i < count; ++i) add_shifted(sum, samples[i]);
    return sum;
  }

  static Moments combine(const Moments& left, const Moments& right) {
    Moments sum;
    sum.weight = left.weight + right.weight;
    const double share = sum.weight > 0 ? right.weight / sum.weight : 0.5;
    for (std::size_t k = 0; k < 3; ++k) sum.center[k] = left.center[k] + share * (right.center[k] - left.center[k]);
    sum.eps2 = left.eps2 + share * (right.eps2 - left.eps2);
    add_shifted(sum, left);
    add_shifted(sum, right);
    return sum;
  }

  void finish(Node& node, const Moments& moments) const {
    // The expansion is in powers of d and of the deviation of eps^2 from its mean.
    double radius2 = 0, spread = 0;
    const auto begin = static_cast<std::size_t>(node.begin), end = begin + static_cast<std::size_t>(node.count);
    const Linear c = moments.center;
    for (std::size_t i = begin; i < end; ++i) {
      const Item& item = items_[i];
      const double dx = item.p[0] - c[0], dy = item.p[1] - c[1], dz = item.p[2] - c[2];
      radius2 = std::max(radius2, dx * dx + dy * dy + dz * dz);
      spread = std::max(spread, std::abs(item.eps2 - moments.eps2));
    }
    const double s = 1 / std::sqrt(std::max(radius2 + spread, 0.25 * moments.eps2)), s2 = s * s;
    node.inverse_scale = s;
    std::copy_n(c.begin(), 3, node.center);
    node.eps2 = static_cast<float>(moments.eps2 * s2);
    for (std::size_t k = 0; k < 3; ++k) node.dipole[k] = static_cast<float>(s2 * moments.N[k]);
    for (std::size_t k = 0; k < 6; ++k) node.quadratic[k] = static_cast<float>(-3 * s2 * s * moments.M[k]);
    for (std::size_t k = 0; k < 10; ++k) node.cubic[k] = static_cast<float>(7.5 * s2 * s2 * moments.Q[k]);
  }

  std::vector<Item> items_;
  std::unique_ptr<Item[]> buffer_;  // uninitialised: only the part written to takes physical memory
  std::vector<Node> nodes_;
  InterruptionPoint pause_{256};
};

}  // namespace

Tree make_tree(const SamplesRef& samples) {
  Tree tree;
  const Index n = samples.points.cols();
  if (n == 0) return tree;
  const Box<3> box = bounding_box<3>(samples.points);
  tree.origin = 0.5 * box.lo + 0.5 * box.hi;
  tree.unit = std::exp2(std::ceil(std::log2(std::max((box.hi - box.lo).maxCoeff(), samples.eps.maxCoeff()))));

  std::vector<Item> items(n);
  for (Index i = 0; i < n; ++i) {
    Item& item = items[i];
    const double weight = samples.areas[i] / tree.unit / tree.unit / two_pi, eps = samples.eps[i] / tree.unit;
    for (Index k = 0; k < 3; ++k) {
      item.p[k] = (samples.points(k, i) - tree.origin[k]) / tree.unit;
      item.m[k] = static_cast<float>(weight * samples.normals(k, i));
    }
    item.eps2 = std::max(std::numeric_limits<float>::min(), static_cast<float>(eps * eps));
    item.index = i;
  }
  std::tie(items, tree.nodes) = Builder(std::move(items)).take();

  const auto padded = static_cast<std::size_t>(n + lanes);
  for (std::size_t k = 0; k < 3; ++k) {
    tree.x[k].resize(padded);
    tree.strength[k].resize(padded);
  }
  tree.eps2.resize(padded, 1.0F);
  std::vector<Index> order(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Item& item = items[i];
    for (std::size_t k = 0; k < 3; ++k) {
      tree.x[k][i] = static_cast<std::int32_t>(std::lround(item.p[k] * Tree::resolution));
      tree.strength[k][i] = item.m[k];
    }
    tree.eps2[i] = item.eps2;
    order[i] = item.index;
  }
  std::vector<Item>().swap(items);  // frees memory before the points are copied
  tree.points = samples.points(Eigen::all, order);
  return tree;
}

Samples samples_of(const Tree& tree) {
  const Index n = tree.points.cols();
  Samples samples{tree.points, Points<3>(3, n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Index i = 0; i < n; ++i) {
    const Point<3> m(tree.strength[0][i], tree.strength[1][i], tree.strength[2][i]);
    const double length = m.norm();
    samples.normals.col(i) = length > 0 ? Point<3>(m / length) : Point<3>::Zero();
    samples.areas[i] = two_pi * length * tree.unit * tree.unit;
    samples.eps[i] = std::sqrt(static_cast<double>(tree.eps2[i])) * tree.unit;
  }
  return samples;
}

}  // namespace csrbf::winding
