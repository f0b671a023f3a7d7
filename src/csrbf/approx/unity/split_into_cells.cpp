#include "csrbf/approx/unity/split_into_cells.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"

#include <array>
#include <span>
#include <utility>

namespace csrbf {
namespace {

// All chosen by hand.
constexpr double nearest_end = 0.3;         // least distance of a split from the ends of the side, as a share of it
constexpr Index median_sample = 63;         // points that the median is estimated from
constexpr double smallest_cell = 1e-9;      // least side of a cell to split, as a share of the extent
constexpr Index enough_parts = 256;         // for the threads: more balance better, fewer need fewer passes
constexpr Index points_per_task = 1 << 14;  // points per task

constexpr std::size_t no_node = std::numeric_limits<std::size_t>::max();

bool splits(const CellNodes& nodes, std::size_t node) {
  return node < nodes.axis.size() && nodes.axis[node] >= 0;
}

// The first point below a node.
Index first_point(const CellNodes& nodes, std::size_t node) {
  while (nodes.axis[node] >= 0) ++node;
  const std::uint32_t cell = nodes.right[node];
  return cell == 0 ? 0 : nodes.ends[cell - 1];
}

// A part of the points and its cell, on the way to the leaves.
template <int Dim>
struct Part {
  Index begin, end;
  Box<Dim> cell;
  Index axis = -1;
  double split = 0;
  Index middle = 0;
  std::size_t child = 0;  // the lower part, among the parts of the next level
  std::size_t node = 0;   // of the tree that the points are sorted by, if it is not below a cell of it

  [[nodiscard]] Part lower(const CellNodes& sorted) const {
    Part part{begin, middle, cell};
    part.cell.hi[axis] = split;
    part.node = splits(sorted, node) ? node + 1 : no_node;
    return part;
  }
  [[nodiscard]] Part upper(const CellNodes& sorted) const {
    Part part{middle, end, cell};
    part.cell.lo[axis] = split;
    part.node = splits(sorted, node) ? sorted.right[node] : no_node;
    return part;
  }
};

template <int Dim>
double near_median(const Located<Dim>* points, Index n, Index axis) {
  std::array<double, median_sample> sample;
  const Index count = std::min(n, median_sample);
  for (Index i = 0; i < count; ++i) sample[i] = points[i * n / count].x[axis];
  return median(std::span(sample.data(), static_cast<std::size_t>(count)));
}

// std::partition by x[axis] < split, with the same result: the first point that is wrong on the left is swapped with
// the last one that is wrong on the right, and so on. Without branches that depend on the points, which would be
// unpredictable.
template <int Dim>
Index move_lower_first(Located<Dim>* points, Index n, Index axis, double split) {
  constexpr Index block = 256;  // points; their indices stay in the first-level cache
  const auto is_lower = [&](Index i) { return points[i].x[axis] < split ? 1 : 0; };
  Index middle = 0;
  for (Index i = 0; i < n; ++i) middle += is_lower(i);
  std::array<Index, block> left, right;  // points on the wrong side in the blocks before `low` and after `high`
  std::size_t lefts = 0, rights = 0, next_left = 0, next_right = 0;
  for (Index low = 0, high = n;;) {
    while (next_left == lefts && low < middle) {
      next_left = lefts = 0;
      for (const Index end = std::min(middle, low + block); low < end; ++low) {
        left[lefts] = low;
        lefts += static_cast<std::size_t>(1 - is_lower(low));
      }
    }
    if (next_left == lefts) return middle;
    while (next_right == rights) {
      next_right = rights = 0;
      for (const Index end = std::max(middle, high - block); high > end;) {
        right[rights] = --high;
        rights += static_cast<std::size_t>(is_lower(high));
      }
    }
    while (next_left < lefts && next_right < rights) std::swap(points[left[next_left++]], points[right[next_right++]]);
  }
}

template <int Dim>
void cut(std::vector<Located<Dim>>& points, Index leaf_size, double smallest, const CellNodes& sorted,
         Part<Dim>& part) {
  const Index n = part.end - part.begin;
  if (n <= leaf_size) return;
  if (splits(sorted, part.node)) {
    part.axis = sorted.axis[part.node];
    part.split = sorted.split[part.node];
    part.middle = first_point(sorted, sorted.right[part.node]);
    return;
  }
  const Point<Dim> extent = part.cell.extent();
  Index axis = 0;
  const double length = extent.maxCoeff(&axis);
  if (!(length > smallest)) return;  // points that all but coincide
  Located<Dim>* first = points.data() + part.begin;
  const double lo = part.cell.lo[axis], hi = part.cell.hi[axis];
  const double split = std::clamp(near_median(first, n, axis), lo + nearest_end * length, hi - nearest_end * length);
  part.axis = axis;
  part.split = split;
  part.middle = part.begin + move_lower_first(first, n, axis, split);
}

// Splits level by level until there are enough parts for all threads; the parts of a level are independent of each
// other. Those of the last level may be cut further.
template <int Dim>
std::vector<std::vector<Part<Dim>>> split_roughly(std::vector<Located<Dim>>& points, const Box<Dim>& box,
                                                  Index leaf_size, double smallest, const CellNodes& sorted) {
  std::vector<std::vector<Part<Dim>>> levels = {{{0, static_cast<Index>(points.size()), box}}};
  while (static_cast<Index>(levels.back().size()) < enough_parts) {
    std::vector<Part<Dim>>& parts = levels.back();
    parallel_for(static_cast<Index>(parts.size()), 1, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) cut(points, leaf_size, smallest, sorted, parts[i]);
    });
    std::vector<Part<Dim>> next;
    for (Part<Dim>& part : parts) {
      if (part.axis < 0) continue;
      part.child = next.size();
      next.push_back(part.lower(sorted));
      next.push_back(part.upper(sorted));
    }
    if (next.empty()) break;
    levels.push_back(std::move(next));
  }
  return levels;
}

void add(CellNodes& nodes, const CellNodes& more) {
  nodes.axis.insert(nodes.axis.end(), more.axis.begin(), more.axis.end());
  nodes.split.insert(nodes.split.end(), more.split.begin(), more.split.end());
  nodes.ends.insert(nodes.ends.end(), more.ends.begin(), more.ends.end());
}

template <int Dim>
void add(CellNodes& nodes, const Part<Dim>& part) {
  nodes.axis.push_back(static_cast<std::int8_t>(part.axis));
  nodes.split.push_back(part.split);
  if (part.axis < 0) nodes.ends.push_back(part.end);
}

// The nodes below a part, itself the first.
template <int Dim>
CellNodes split_all(std::vector<Located<Dim>>& points, const Part<Dim>& whole, Index leaf_size, double smallest,
                    const CellNodes& sorted) {
  CellNodes branch;
  std::vector<Part<Dim>> stack = {whole};
  while (!stack.empty()) {
    Part<Dim> part = stack.back();
    stack.pop_back();
    cut(points, leaf_size, smallest, sorted, part);
    add(branch, part);
    if (part.axis < 0) continue;
    stack.push_back(part.upper(sorted));
    stack.push_back(part.lower(sorted));
  }
  return branch;
}

template <int Dim>
std::vector<CellNodes> split_all(std::vector<Located<Dim>>& located, const std::vector<Part<Dim>>& parts,
                                 Index leaf_size, double smallest, const CellNodes& sorted) {
  std::vector<CellNodes> branches(parts.size());
  const auto compute = [&](Index begin, Index end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      branches[i] = split_all(located, parts[i], leaf_size, smallest, sorted);
  };
  parallel_for(static_cast<Index>(parts.size()), 1, compute);
  return branches;
}

// In preorder, the node after a cell is the upper part of the last split that has none yet.
void link(CellNodes& nodes) {
  nodes.right.resize(nodes.axis.size());
  std::vector<std::size_t> open;
  std::uint32_t cells = 0;
  for (std::size_t node = 0; node < nodes.axis.size(); ++node) {
    if (node > 0 && nodes.axis[node - 1] < 0) {
      nodes.right[open.back()] = static_cast<std::uint32_t>(node);
      open.pop_back();
    }
    if (nodes.axis[node] < 0) {
      nodes.right[node] = cells++;
    } else {
      open.push_back(node);
    }
  }
}

}  // namespace

template <int Dim>
CellNodes split_into_cells(const PointsRef<Dim>& points, const Box<Dim>& box, Index leaf_size,
                           std::vector<Located<Dim>>& located, const CellNodes& sorted) {
  located.resize(points.cols());
  parallel_for(points.cols(), points_per_task, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) located[i] = {points.col(i), static_cast<std::uint32_t>(i)};
  });
  const double coordinate = std::max(box.lo.cwiseAbs().maxCoeff(), box.hi.cwiseAbs().maxCoeff());
  const double smallest = std::max(smallest_cell * box.extent().maxCoeff(), 4 * smallest_side * coordinate);
  const auto levels = split_roughly(located, box, leaf_size, smallest, sorted);
  const std::vector<CellNodes> branches = split_all<Dim>(located, levels.back(), leaf_size, smallest, sorted);

  CellNodes nodes;
  std::vector<std::pair<std::size_t, std::size_t>> stack = {{0, 0}};  // level and part
  while (!stack.empty()) {
    const auto [level, i] = stack.back();
    stack.pop_back();
    if (level + 1 == levels.size()) {
      add(nodes, branches[i]);
      continue;
    }
    const Part<Dim>& part = levels[level][i];
    add(nodes, part);
    if (part.axis < 0) continue;
    stack.push_back({level + 1, part.child + 1});
    stack.push_back({level + 1, part.child});
  }
  link(nodes);
  return nodes;
}

#define CSRBF_INSTANTIATE(Dim)                                                                                        \
  template CellNodes split_into_cells<Dim>(const PointsRef<Dim>&, const Box<Dim>&, Index, std::vector<Located<Dim>>&, \
                                           const CellNodes&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
