#include "csrbf/approx/unity/cover.hpp"

#include "csrbf/approx/unity/split_into_cells.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"

#include <cmath>
#include <limits>
#include <numeric>

namespace csrbf {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double margin = 1e-9;   // around the points, as a share of the extent; chosen by hand, far above rounding
constexpr Index grain = 1 << 14;  // points per task, chosen by hand

}  // namespace

template <int Dim>
Cover<Dim>::Cover(const PointsRef<Dim>& points, Index leaf_size, double growth, CoverUse use) {
  require(points.cols() > 0, "Cover", "points", 0, "at least one is needed");
  require(std::int64_t{points.cols()} < (std::int64_t{1} << 32), "Cover", "points", points.cols(),
          "must be fewer than 2^32");
  require(growth > 1, "Cover", "growth", growth, "must be above 1, so that supports overlap");
  tree_.growth = growth;
  tree_.box = bounding_box<Dim>(points);
  const double largest = tree_.box.extent().maxCoeff();
  for (int a = 0; a < Dim; ++a) {  // no side of length 0
    const double coordinate = std::max(std::abs(tree_.box.lo[a]), std::abs(tree_.box.hi[a]));
    const double pad =
        std::max(margin * (largest > 0 ? largest : std::max(1.0, coordinate)), smallest_side * coordinate);
    tree_.box.lo[a] -= pad;
    tree_.box.hi[a] += pad;
  }
  build(points, {}, leaf_size, use);
}

template <int Dim>
Cover<Dim>::Cover(Cover sorted, Index leaf_size) {
  tree_.box = sorted.box();
  tree_.growth = sorted.growth();
  const CellNodes nodes{std::move(sorted.tree_.axis),
                        std::move(sorted.tree_.split),
                        std::move(sorted.tree_.right),
                        {sorted.begin_.begin() + 1, sorted.begin_.end()}};
  build(sorted.points_, nodes, leaf_size, CoverUse::evaluation);
  for (auto& id : order_) id = sorted.order_[id];
}

template <int Dim>
void Cover<Dim>::build(const PointsRef<Dim>& points, const CellNodes& sorted, Index leaf_size, CoverUse use) {
  require(leaf_size >= 1, "Cover", "leaf_size", leaf_size, "must be at least 1");
  std::vector<Located<Dim>> located;
  CellNodes nodes = split_into_cells<Dim>(points, tree_.box, leaf_size, located, sorted);
  tree_.axis = std::move(nodes.axis);
  tree_.split = std::move(nodes.split);
  tree_.right = std::move(nodes.right);
  begin_ = {0};
  begin_.insert(begin_.end(), nodes.ends.begin(), nodes.ends.end());
  points_.resize(Dim, points.cols());
  order_.resize(located.size());
  parallel_for(points.cols(), grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      points_.col(i) = located[at].x;
      order_[at] = located[at].id;
    }
  });
  make_cells();
  if (use == CoverUse::fitting) return;
  make_grid();
  find_supports();
}

template <int Dim>
Cover<Dim>::Cover(Tree tree) : tree_(std::move(tree)) {
  make_cells();
  make_grid();
  find_supports();
}

template <int Dim>
void Cover<Dim>::make_cells() {
  std::vector<std::pair<std::size_t, Box<Dim>>> stack = {{0, tree_.box}};
  while (!stack.empty()) {
    const auto [node, box] = stack.back();
    stack.pop_back();
    const int axis = tree_.axis[node];
    if (axis < 0) {
      cells_.push_back(box);
      continue;
    }
    Box<Dim> lower = box, upper = box;
    lower.hi[axis] = upper.lo[axis] = tree_.split[node];
    stack.push_back({tree_.right[node], upper});
    stack.push_back({node + 1, lower});
  }
}

template <int Dim>
Eigen::MatrixXd Cover<Dim>::in_order(const Eigen::Ref<const Eigen::MatrixXd>& rows) const {
  require(rows.rows() == 0 || rows.rows() == std::ssize(order_), "Cover::in_order", "rows", rows.rows(),
          "there must be one per point, or none at all");
  Eigen::MatrixXd sorted(rows.rows(), rows.cols());
  parallel_for(rows.rows(), grain, [&](Index begin, Index end) {
    for (Index column = 0; column < rows.cols(); ++column)
      for (Index i = begin; i < end; ++i) sorted(i, column) = rows(order_[i], column);
  });
  return sorted;
}

template <int Dim>
void Cover<Dim>::supports_over(const Box<Dim>& box, std::vector<std::uint32_t>& supports) const {
  supports.clear();
  for_each_cell(box, [&](std::uint32_t cell) {
    const auto over = supports_over(static_cast<Index>(cell));
    supports.insert(supports.end(), over.begin(), over.end());
  });
  std::sort(supports.begin(), supports.end());
  supports.erase(std::unique(supports.begin(), supports.end()), supports.end());
}

// For every support the cells it reaches into; then, for every cell, the supports.
template <int Dim>
void Cover<Dim>::find_supports() {
  std::vector<std::vector<std::uint32_t>> reached(cells_.size());
  parallel_for(size(), 256, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Point<Dim> center = cell(i).center(), half = 0.5 * growth() * cell(i).extent();
      // The weights are 0 on the border of a support.
      const Point<Dim> last = (center + half).unaryExpr([](double x) { return std::nextafter(x, -infinity); });
      for_each_cell({center - half, last}, [&](std::uint32_t c) { reached[i].push_back(c); });
    }
  });
  over_begin_.assign(cells_.size() + 1, 0);
  for (const auto& list : reached)
    for (const std::uint32_t c : list) ++over_begin_[c + 1];
  std::partial_sum(over_begin_.begin(), over_begin_.end(), over_begin_.begin());
  over_.resize(over_begin_.back());
  std::vector<std::size_t> next(over_begin_.begin(), over_begin_.end() - 1);
  for (std::size_t i = 0; i < reached.size(); ++i)
    for (const std::uint32_t c : reached[i]) over_[next[c]++] = static_cast<std::uint32_t>(i);
}

template <int Dim>
void Cover<Dim>::make_grid() {
  constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();  // of the coordinates
  const Point<Dim> margin_of_part = rounding * box().lo.cwiseAbs().cwiseMax(box().hi.cwiseAbs());
  parts_ = std::max<Index>(1, static_cast<Index>(std::pow(static_cast<double>(size()), 1.0 / Dim)));
  const Point<Dim> side = box().extent() / static_cast<double>(parts_);
  parts_per_length_ = side.cwiseInverse();
  start_.resize(std::llround(std::pow(static_cast<double>(parts_), Dim)));
  parallel_for(static_cast<Index>(start_.size()), 256, [&](Index begin, Index end) {
    for (Index part = begin; part < end; ++part) {
      Point<Dim> lo;
      Index rest = part;
      for (int a = 0; a < Dim; ++a, rest /= parts_)
        lo[a] = box().lo[a] + static_cast<double>(rest % parts_) * side[a] - margin_of_part[a];
      const Point<Dim> hi = lo + side + 2 * margin_of_part;
      std::size_t node = 0;
      for (int axis = tree_.axis[0]; axis >= 0; axis = tree_.axis[node]) {
        if (hi[axis] < tree_.split[node]) {
          ++node;
        } else if (lo[axis] >= tree_.split[node]) {
          node = tree_.right[node];
        } else {
          break;
        }
      }
      start_[part] = static_cast<std::uint32_t>(node);
    }
  });
}

template <int Dim>
Index Cover<Dim>::find(const Point<Dim>& x) const {
  Index part = 0;
  bool inside = true;
  for (int a = Dim - 1; a >= 0; --a) {
    const double t = (x[a] - box().lo[a]) * parts_per_length_[a];
    inside = inside && t >= 0 && t < static_cast<double>(parts_);  // not for NaN
    part = parts_ * part + (inside ? static_cast<Index>(t) : 0);
  }
  std::size_t node = inside ? start_[part] : 0;
  while (tree_.axis[node] >= 0) node = x[tree_.axis[node]] < tree_.split[node] ? node + 1 : tree_.right[node];
  return tree_.right[node];
}

#define CSRBF_INSTANTIATE(Dim) template class Cover<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
