#include "csrbf/approx/sums/box_tree.hpp"

#include "csrbf/core/parallel.hpp"

#include <numeric>
#include <set>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index task_boxes = 128;            // targets per task: enough for long products, few enough for all threads
constexpr int most_offsets[] = {63, 15, 7};  // along an axis, for kernels that are not smooth at larger boxes
constexpr double margin = 1.3;               // of the cube around the points, where sums are found everywhere
constexpr Index entries_per_term = 40;       // of a translation, as fast as one term of a direct sum
constexpr Index least_leaf = 40;             // points of a box that is not divided, at least ...
constexpr Index leaf_per_rank = 2;           // ... and, for one sum at each point, this times the rank of expansions
constexpr Index division_cost = 15;  // terms of direct sums that cost as much as the expansions of a child, over rank^2

// Whether phi(t r) = c(t) phi(r), so that all levels share their operators.
bool homogeneous(const Kernel& kernel) {
  if (kernel.has_scale()) return false;
  const double one = kernel.value(1), two = kernel.value(2), four = kernel.value(4);
  return one != 0 && std::abs(one * four - two * two) <= 1e-12 * two * two;
}

}  // namespace

template <int Dim>
BoxTree<Dim>::BoxTree(const PointsRef<Dim>& points, const Kernel& kernel, double support, const TreeOptions& options)
    : asked_leaf_size(options.leaf_size), everywhere(options.everywhere), tolerance(options.tolerance) {
  const Box<Dim> bounds = bounding_box<Dim>(points);
  side = bounds.extent().maxCoeff() * (everywhere ? margin : 1 + 1e-12);
  if (!(side > 0)) side = support;
  corner = bounds.center().array() - .5 * side;
  order.resize(points.cols());
  std::iota(order.begin(), order.end(), Index{0});

  TreeBox<Dim> root;
  root.count = points.cols();
  root.child.fill(-1);
  root.near = {0};
  boxes.push_back(root);
  level_begin = {0, 1};
  choose_operators(0, kernel, support);
  tasks.emplace_back();
  std::vector<Index> scratch(points.cols());
  for (int level = 0; level < last_level; ++level) {
    const Index end = level_begin[level + 1];
    for (Index b = level_begin[level]; b < end; ++b)
      if (needs_division(boxes[b])) divide(b, points, scratch);
    if (std::ssize(boxes) == end) break;
    level_begin.push_back(std::ssize(boxes));
    choose_operators(level + 1, kernel, support);
    list(level + 1);
  }
}

template <int Dim>
Point<Dim> BoxTree<Dim>::center(const TreeBox<Dim>& box) const {
  const double width = std::ldexp(side, -box.level);
  Point<Dim> c = corner;
  for (int d = 0; d < Dim; ++d) c[d] += (box.cell[d] + .5) * width;
  return c;
}

template <int Dim>
Index BoxTree<Dim>::leaf_at(const Point<Dim>& x) const {
  const Point<Dim> unit = (x - corner) / side;
  if (!((unit.array() >= 0).all() && (unit.array() < 1).all())) return -1;
  Index b = 0;
  while (!boxes[b].leaf()) {
    const Point<Dim> c = center(boxes[b]);
    unsigned which = 0;
    for (int d = 0; d < Dim; ++d) which |= (x[d] >= c[d] ? 1U : 0U) << d;
    if (boxes[b].child[which] < 0) return -1;
    b = boxes[b].child[which];
  }
  return b;
}

template <int Dim>
bool BoxTree<Dim>::needs_division(const TreeBox<Dim>& box) const {
  if (!few(box)) return true;
  if (box.count == 0 && !everywhere) return false;
  if (std::all_of(box.near.begin(), box.near.end(), [&](std::int32_t b) { return few(boxes[b]); })) return false;
  if (everywhere) return true;
  const Index rank = operators[box.level] == nullptr ? 0 : operators[box.level]->rank();
  Index sources = 0;
  for (const std::int32_t b : box.near) sources += boxes[b].count;
  return box.count * sources > division_cost * rank * rank * std::min<Index>(box.count, box.child.size());
}

template <int Dim>
void BoxTree<Dim>::divide(Index b, const PointsRef<Dim>& points, std::vector<Index>& scratch) {
  const TreeBox<Dim> box = boxes[b];
  const Point<Dim> c = center(box);
  const auto corner_of = [&](Index i) {
    unsigned which = 0;
    for (int d = 0; d < Dim; ++d) which |= (points(d, i) >= c[d] ? 1U : 0U) << d;
    return which;
  };
  std::array<Index, (1U << Dim) + 1> begin{};
  for (Index k = box.first; k < box.first + box.count; ++k) ++begin[corner_of(order[k]) + 1];
  for (unsigned which = 0; which < (1U << Dim); ++which) begin[which + 1] += begin[which];
  std::array<Index, (1U << Dim) + 1> next = begin;
  std::copy_n(order.begin() + box.first, box.count, scratch.begin());
  for (Index k = 0; k < box.count; ++k) order[box.first + next[corner_of(scratch[k])]++] = scratch[k];
  for (unsigned which = 0; which < (1U << Dim); ++which) {
    const Index count = begin[which + 1] - begin[which];
    if (count == 0 && !everywhere) continue;
    TreeBox<Dim> child;
    child.level = box.level + 1;
    for (int d = 0; d < Dim; ++d) child.cell[d] = 2 * box.cell[d] + static_cast<int>((which >> d) % 2);
    child.first = box.first + begin[which];
    child.count = count;
    child.parent = b;
    child.child.fill(-1);
    boxes[b].child[which] = static_cast<std::int32_t>(boxes.size());
    boxes.push_back(std::move(child));
  }
}

// Where a box at a distance was not far at the level above, its children can lie twice as far apart.
template <int Dim>
void BoxTree<Dim>::choose_operators(int level, const Kernel& kernel, double support) {
  const double half_width = half(level) / support;
  const auto above = level > 0 ? operators.back() : nullptr;
  factor.push_back(1);
  if (level < 2) {  // all boxes touch
    operators.push_back(nullptr);
  } else if (homogeneous(kernel)) {
    operators.push_back(above != nullptr ? above
                                         : std::make_shared<BoxOperators<Dim>>(kernel, 1., tolerance, 3, false));
    factor.back() = kernel.value(half_width) / kernel.value(1);
  } else {
    const bool has_parent = above != nullptr && above->rank() > 0;
    int farthest = 3;
    if (above != nullptr && above->any_near()) farthest = std::min(2 * above->farthest() + 1, most_offsets[Dim - 1]);
    operators.push_back(std::make_shared<BoxOperators<Dim>>(kernel, half_width, tolerance, farthest, has_parent));
  }
  const Index rank = operators.back() == nullptr ? 0 : operators.back()->rank();
  // Sums everywhere are many for one set of expansions: small boxes pay.
  const Index by_cost = everywhere ? least_leaf : std::max(least_leaf, leaf_per_rank * rank);
  const Index points = asked_leaf_size > 0 ? asked_leaf_size : by_cost;
  leaf_size.push_back(level > 0 ? std::max(leaf_size.back(), points) : points);
}

template <int Dim>
void BoxTree<Dim>::list(int level) {
  const Index begin = level_begin[level], end = level_begin[level + 1];
  tasks.emplace_back((end - begin + task_boxes - 1) / task_boxes);
  parallel_for(end - begin, task_boxes, [&](Index first, Index last) {
    std::vector<std::pair<std::int64_t, std::int32_t>> far;
    TranslationTask& task = tasks[level][first / task_boxes];
    std::vector<std::pair<std::int64_t, TranslationTask::Pair>> all;
    for (Index b = begin + first; b < begin + last; ++b) {
      far.clear();
      list_sources(b, far);
      for (const auto& [key, source] : far) all.push_back({key, {static_cast<std::int32_t>(b), source}});
    }
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [key, pair] : all) {
      const Index code = key >> Dim;
      const auto mirrored = static_cast<unsigned>(key & ((1U << Dim) - 1));
      if (task.groups.empty() || task.groups.back().code != code || task.groups.back().mirrored != mirrored)
        task.groups.push_back({code, mirrored, std::ssize(task.pairs), std::ssize(task.pairs)});
      task.pairs.push_back(pair);
      task.groups.back().end = std::ssize(task.pairs);
    }
  });
  std::set<Index> used;
  for (const TranslationTask& task : tasks[level])
    for (const TranslationTask::Group& group : task.groups) used.insert(group.code);
  if (operators[level] != nullptr) operators[level]->prepare({used.begin(), used.end()});
}

// Fills `near` of the target; `far` gets the sources of translations by offset.
template <int Dim>
void BoxTree<Dim>::list_sources(Index b, std::vector<std::pair<std::int64_t, std::int32_t>>& far) {
  TreeBox<Dim>& target = boxes[b];
  const BoxOperators<Dim>* const level = operators[target.level].get();
  // As many sums as a translation is worth.
  const Index worth = level == nullptr ? 0 : level->rank() * level->rank() / entries_per_term;
  const auto consider = [&](std::int32_t s) {
    const TreeBox<Dim>& source = boxes[s];
    BoxOffset<Dim> offset;
    std::int64_t mirrored = 0;
    int largest = 0;
    for (int d = 0; d < Dim; ++d) {
      const int difference = target.cell[d] - source.cell[d];
      offset[d] = std::abs(difference);
      if (difference < 0) mirrored |= 1 << d;
      largest = std::max(largest, offset[d]);
    }
    if (largest < 2) return target.near.push_back(s);
    const auto reach = level->reach(offset);
    if (reach == BoxOperators<Dim>::Reach::negligible) return;
    if (reach == BoxOperators<Dim>::Reach::far &&
        (!few(source) || std::max<Index>(target.count, everywhere ? least_leaf : 1) * source.count > worth))
      return far.emplace_back((level->code(offset) << Dim) | mirrored, s), void();
    target.near.push_back(s);
  };
  for (const std::int32_t s : boxes[target.parent].near) {
    const TreeBox<Dim>& source = boxes[s];
    if (few(source)) {
      target.near.push_back(s);
      continue;
    }
    for (const std::int32_t c : source.child)
      if (c >= 0 && boxes[c].count > 0) consider(c);
  }
}

template struct BoxTree<1>;
template struct BoxTree<2>;
template struct BoxTree<3>;

}  // namespace csrbf
