#include "csrbf/implicit/mesh/triangle_tree.hpp"

#include "csrbf/core/interruption.hpp"
#include "csrbf/core/parallel.hpp"

namespace csrbf {
namespace {

constexpr Index leaf_size = 4;                       // triangles at most; chosen by hand
constexpr int bin_count = 16;                        // candidates for a split (Wald 2007)
constexpr int max_area_depth = max_tree_depth - 32;  // deeper nodes are halved by count, at most 31 times
constexpr float infinity = std::numeric_limits<float>::infinity();

struct Bounds {
  std::array<float, 3> lo{infinity, infinity, infinity};
  std::array<float, 3> hi{-infinity, -infinity, -infinity};

  void add(const std::array<float, 3>& other_lo, const std::array<float, 3>& other_hi) {
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], other_lo[k]);
      hi[k] = std::max(hi[k], other_hi[k]);
    }
  }
  void add(const Bounds& other) { add(other.lo, other.hi); }
  [[nodiscard]] float area() const {
    const float x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
    return x >= 0 ? x * y + y * z + z * x : 0.0F;
  }
};

// Twice the centre of a box: only differences matter.
float center(const TriangleBox& box, std::size_t axis) {
  return box.lo[axis] + box.hi[axis];
}

// Consecutive triangles in leaf order that become one subtree.
struct Range {
  Index begin = 0, end = 0;
  Bounds bounds, centers;

  [[nodiscard]] Index size() const { return end - begin; }
  void measure(const std::vector<TriangleBox>& boxes) {
    bounds = centers = Bounds();
    for (Index i = begin; i < end; ++i) {
      const TriangleBox& box = boxes[i];
      const std::array<float, 3> c{center(box, 0), center(box, 1), center(box, 2)};
      bounds.add(box.lo, box.hi);
      centers.add(c, c);
    }
  }
};

struct Bins {
  std::size_t axis = 0;
  float origin = 0;
  float scale = 0;  // bins per unit; 0 when all centres coincide

  explicit Bins(const Bounds& centers) {
    for (std::size_t k = 1; k < 3; ++k)
      if (centers.hi[k] - centers.lo[k] > centers.hi[axis] - centers.lo[axis]) axis = k;
    origin = centers.lo[axis];
    const float extent = centers.hi[axis] - origin;
    if (extent > std::numeric_limits<float>::min()) scale = bin_count / extent;
  }
  [[nodiscard]] int operator()(const TriangleBox& box) const {
    return std::min(bin_count - 1, static_cast<int>((center(box, axis) - origin) * scale));
  }
};

// Number of bins on the left of the cheapest plane: area times count, summed over both sides.
int cheapest_plane(const std::vector<TriangleBox>& boxes, const Range& range, const Bins& bins) {
  std::array<Bounds, bin_count> bounds;
  std::array<Index, bin_count> count{};
  for (Index i = range.begin; i < range.end; ++i) {
    const auto bin = static_cast<std::size_t>(bins(boxes[i]));
    bounds[bin].add(boxes[i].lo, boxes[i].hi);
    ++count[bin];
  }
  std::array<float, bin_count> right_cost{};
  Bounds side;
  Index members = 0;
  for (std::size_t plane = bin_count - 1; plane > 0; --plane) {
    side.add(bounds[plane]);
    members += count[plane];
    right_cost[plane] = side.area() * static_cast<float>(members);
  }
  int best = 1;
  float best_cost = infinity;
  side = Bounds();
  members = 0;
  for (std::size_t plane = 1; plane < bin_count; ++plane) {
    side.add(bounds[plane - 1]);
    members += count[plane - 1];
    const float cost = side.area() * static_cast<float>(members) + right_cost[plane];
    if (cost < best_cost && members > 0 && members < range.size()) {
      best_cost = cost;
      best = static_cast<int>(plane);
    }
  }
  return best;
}

std::array<Range, 2> split(std::vector<TriangleBox>& boxes, const Range& range, int depth) {
  const Bins bins(range.centers);
  const auto first = boxes.begin() + range.begin, last = boxes.begin() + range.end;
  auto middle = first + range.size() / 2;
  if (bins.scale > 0 && depth < max_area_depth) {
    const int plane = cheapest_plane(boxes, range, bins);
    middle = std::partition(first, last, [&](const TriangleBox& box) { return bins(box) < plane; });
    if (middle == first || middle == last) middle = first + range.size() / 2;
  } else {
    std::nth_element(first, middle, last, [&](const TriangleBox& a, const TriangleBox& b) {
      return center(a, bins.axis) < center(b, bins.axis);
    });
  }
  if (range.size() > (Index{1} << 16)) stop_if_interrupted();
  std::array<Range, 2> halves;
  halves[0] = {.begin = range.begin, .end = middle - boxes.begin(), .bounds = {}, .centers = {}};
  halves[1] = {.begin = halves[0].end, .end = range.end, .bounds = {}, .centers = {}};
  for (Range& half : halves) half.measure(boxes);
  return halves;
}

// A deferred subtree, and the slot that it belongs to.
struct Pending {
  Range range;
  int depth = 0;
  Index parent = 0;
  std::size_t slot = 0;
  std::vector<TreeNode> nodes;
};

class Builder {
 public:
  /// Ranges of at most `deferred_size` triangles go to `pending`; 0 builds everything.
  Builder(std::vector<TriangleBox>& boxes, std::vector<TreeNode>& nodes, Index deferred_size,
          std::vector<Pending>* pending)
      : boxes_(boxes), nodes_(nodes), deferred_size_(deferred_size), pending_(pending) {}

  Index build(const Range& range, int depth) {
    stop_if_interrupted();
    const auto index = std::ssize(nodes_);
    nodes_.emplace_back();
    std::array<Range, 4> children;
    const std::size_t count = split_in_four(range, depth, children);
    for (std::size_t k = 0; k < count; ++k) place(children[k], depth, index, k);
    return index;
  }

 private:
  std::size_t split_in_four(const Range& range, int depth, std::array<Range, 4>& children) {
    children[0] = range;
    std::size_t count = 1;
    while (count < 4) {
      std::size_t largest = count;
      for (std::size_t k = 0; k < count; ++k) {
        if (children[k].size() <= leaf_size) continue;
        if (largest == count || children[k].bounds.area() > children[largest].bounds.area()) largest = k;
      }
      if (largest == count) break;
      const std::array<Range, 2> halves = split(boxes_, children[largest], depth);
      children[largest] = halves[0];
      children[count++] = halves[1];
    }
    return count;
  }

  void place(const Range& child, int depth, Index parent, std::size_t slot) {
    for (std::size_t k = 0; k < 3; ++k) {
      nodes_[parent].lo[k][slot] = child.bounds.lo[k];
      nodes_[parent].hi[k][slot] = child.bounds.hi[k];
    }
    if (child.size() <= leaf_size) {
      nodes_[parent].child[slot] = ~static_cast<std::int32_t>(child.begin);
      TriangleBox& last = boxes_[child.end - 1];
      last.triangle = ~last.triangle;
    } else if (child.size() <= deferred_size_) {
      pending_->push_back({child, depth + 1, parent, slot, {}});
    } else {
      const Index node = build(child, depth + 1);
      nodes_[parent].child[slot] = static_cast<std::int32_t>(node);
    }
  }

  std::vector<TriangleBox>& boxes_;
  std::vector<TreeNode>& nodes_;
  Index deferred_size_;
  std::vector<Pending>* pending_;
};

}  // namespace

TreeNode::TreeNode() : child{} {
  lo.fill(PerChild::Constant(infinity));
  hi.fill(PerChild::Constant(-infinity));
}

std::vector<TreeNode> build_triangle_tree(std::vector<TriangleBox>& boxes) {
  std::vector<TreeNode> nodes;
  std::vector<Pending> pending;
  Range all{.begin = 0, .end = std::ssize(boxes), .bounds = {}, .centers = {}};
  all.measure(boxes);
  // Subtrees built in parallel: enough to balance threads, large enough to hide the cost of a task. Chosen by hand.
  constexpr Index subtrees = 128;
  constexpr Index smallest_subtree = 2048;  // triangles
  Builder(boxes, nodes, std::max(smallest_subtree, all.size() / subtrees), &pending).build(all, 0);

  parallel_for(std::ssize(pending), 1, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      Builder(boxes, pending[i].nodes, 0, nullptr).build(pending[i].range, pending[i].depth);
  });

  for (Pending& subtree : pending) {
    const auto offset = static_cast<std::int32_t>(nodes.size());
    nodes[subtree.parent].child[subtree.slot] = offset;
    for (TreeNode& node : subtree.nodes) {
      for (std::size_t k = 0; k < 4; ++k)
        if (node.child[k] >= 0) node.child[k] += offset;
      nodes.push_back(node);
    }
  }
  return nodes;
}

}  // namespace csrbf
