#include "csrbf/approx/sums/fast_sum.hpp"

#include "csrbf/approx/sums/nodal_products.hpp"
#include "csrbf/approx/sums/radial_sums.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/panel_product.hpp"

#include <algorithm>
#include <bit>

namespace csrbf {
namespace {

constexpr Index slot_width = 8;  // of RadialBatch
constexpr Index grain = 16;      // boxes per task, chosen by hand

constexpr Index padded_slots(Index n) {
  return (n + slot_width - 1) / slot_width * slot_width;
}

template <int Dim>
const PointsRef<Dim>& checked(const PointsRef<Dim>& centers, double support, const TreeOptions& options) {
  require(centers.allFinite(), "FastSum", "centers", "NaN or infinity", "every coordinate must be finite");
  require(std::isfinite(support) && support > 0, "FastSum", "support", support, "must be positive and finite");
  require(options.tolerance > 0, "FastSum", "tolerance", options.tolerance, "must be positive");
  return centers;
}

}  // namespace

template <int Dim>
FastSum<Dim>::FastSum(const PointsRef<Dim>& centers, const Kernel& kernel, double support, const TreeOptions& options)
    : kernel_(kernel), support_(support), tree_(checked<Dim>(centers, support, options), kernel, support, options) {
  number_slots(centers);
  list_shifts();
}

// For the points of each box with few, in the order of the points, so that neighbours are together.
template <int Dim>
void FastSum<Dim>::number_slots(const PointsRef<Dim>& centers) {
  slot_.assign(tree_.boxes.size(), -1);
  std::vector<Index> holders;
  for (Index b = 0; b < std::ssize(tree_.boxes); ++b) {
    const TreeBox<Dim>& box = tree_.boxes[b];
    const bool highest = box.parent < 0 || !tree_.few(tree_.boxes[box.parent]);
    if (box.count > 0 && tree_.few(box) && highest) holders.push_back(b);
  }
  std::sort(holders.begin(), holders.end(),
            [&](Index a, Index b) { return tree_.boxes[a].first < tree_.boxes[b].first; });
  Index slots = 0;
  for (const Index b : holders) {
    slot_[b] = slots;
    slots += padded_slots(tree_.boxes[b].count);
  }
  span_.assign(tree_.boxes.size(), {slots, 0});
  for (Index b = std::ssize(tree_.boxes) - 1; b >= 0; --b) {
    const TreeBox<Dim>& box = tree_.boxes[b];
    if (slot_[b] >= 0) span_[b] = {slot_[b], slot_[b] + padded_slots(box.count)};
    if (tree_.few(box)) continue;
    for (const std::int32_t child : box.child) {
      if (child < 0) continue;
      span_[b].begin = std::min(span_[b].begin, span_[child].begin);
      span_[b].end = std::max(span_[b].end, span_[child].end);
    }
  }
  position_.resize(slots, Dim);
  shape_ = Eigen::VectorXd::Constant(slots, 1 / (support_ * support_));
  for (const Index b : holders) {
    const TreeBox<Dim>& box = tree_.boxes[b];
    for (Index k = 0; k < padded_slots(box.count); ++k)
      position_.row(slot_[b] + k) = centers.col(tree_.order[box.first + std::min(k, box.count - 1)]).transpose();
  }
}

template <int Dim>
void FastSum<Dim>::list_shifts() {
  to_parent_.resize(tree_.levels());
  for (int level = 2; level + 1 < tree_.levels(); ++level) {
    const auto& here = tree_.operators[level];
    const auto& below = tree_.operators[level + 1];
    if (here->rank() == 0 || below->rank() == 0) continue;
    if (level > 2 && here == below) {
      to_parent_[level] = to_parent_[level - 1];
      continue;
    }
    for (unsigned corner = 0; corner < (1U << Dim); ++corner)
      to_parent_[level].push_back(here->to_parent(*below, corner));
  }
}

template <int Dim>
Index FastSum<Dim>::first_slot(const TreeBox<Dim>& box) const {
  Index holder = &box - tree_.boxes.data();
  while (slot_[holder] < 0) holder = tree_.boxes[holder].parent;
  return slot_[holder] + box.first - tree_.boxes[holder].first;
}

template <int Dim>
Points<Dim> FastSum<Dim>::points_of(const TreeBox<Dim>& box) const {
  return position_.middleRows(first_slot(box), box.count).transpose();
}

template <int Dim>
Eigen::VectorXd FastSum<Dim>::to_slots(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const {
  Eigen::VectorXd slots = Eigen::VectorXd::Zero(shape_.size());
  for (Index b = 0; b < std::ssize(tree_.boxes); ++b) {
    if (slot_[b] < 0) continue;
    const TreeBox<Dim>& box = tree_.boxes[b];
    for (Index k = 0; k < box.count; ++k) slots[slot_[b] + k] = coefficients[tree_.order[box.first + k]];
  }
  return slots;
}

// Upwards: from points to the boxes that hold them, from boxes to their parents.
template <int Dim>
void FastSum<Dim>::gather_sources(FarField& field) const {
  for (int level = tree_.levels() - 1; level >= 2; --level) {
    const BoxOperators<Dim>& here = *tree_.operators[level];
    if (here.rank() == 0) return;
    const Index begin = tree_.level_begin[level], count = tree_.level_begin[level + 1] - begin;
    const Index rank = here.rank(), nodes = here.basis().rows(), slab = here.slab();
    Eigen::MatrixXd& source = field.source[level];
    source.setZero(rank, count);
    parallel_for(count, grain, [&](Index first, Index last) {
      Eigen::MatrixXd nodal(nodes, last - first);
      nodal.setZero();
      for (Index k = first; k < last; ++k) {
        const TreeBox<Dim>& box = tree_.boxes[begin + k];
        if (slot_[begin + k] >= 0) {
          const Points<Dim> unit = (points_of(box).colwise() - tree_.center(box)) / tree_.half(level);
          const NodalProducts<Dim> products(here, unit, 0);
          const Eigen::MatrixXd weighted =
              products.others({}) * field.slots.segment(slot_[begin + k], box.count).asDiagonal();
          panel_product(weighted.data(), slab, box.count, products.first(0).data(), box.count, here.chebyshev().order(),
                        nodal.col(k - first).data());
        } else if (!tree_.few(box)) {
          for (unsigned corner = 0; corner < box.child.size(); ++corner) {
            if (box.child[corner] < 0) continue;
            const Index child = box.child[corner] - tree_.level_begin[level + 1];
            const Eigen::MatrixXd& shift = to_parent_[level][corner];
            panel_product(shift.data(), rank, shift.cols(), field.source[level + 1].col(child).data(), shift.cols(), 1,
                          source.col(k).data());
          }
        }
      }
      panel_product(here.transposed().data(), rank, nodes, nodal.data(), nodes, last - first, source.col(first).data());
    });
  }
}

// Across, and downwards from boxes to their children.
template <int Dim>
void FastSum<Dim>::translate(FarField& field) const {
  for (int level = 2; level < tree_.levels(); ++level) {
    const BoxOperators<Dim>& here = *tree_.operators[level];
    if (here.rank() == 0) continue;
    const Index begin = tree_.level_begin[level], count = tree_.level_begin[level + 1] - begin, rank = here.rank();
    Eigen::MatrixXd& local = field.local[level];
    const Eigen::MatrixXd& source = field.source[level];
    local.setZero(rank, count);
    const std::vector<TranslationTask>& tasks = tree_.tasks[level];
    parallel_for(std::ssize(tasks), 1, [&](Index first, Index last) {
      Eigen::MatrixXd in, out;
      Eigen::VectorXd sign(rank);
      for (Index t = first; t < last; ++t) {
        for (const TranslationTask::Group& group : tasks[t].groups) {
          const Index pairs = group.end - group.begin;
          for (Index i = 0; i < rank; ++i)
            sign[i] = std::popcount(here.odd_axes()[i] & group.mirrored) % 2 != 0 ? -1 : 1;
          in.resize(rank, pairs);
          out.setZero(rank, pairs);
          for (Index k = 0; k < pairs; ++k)
            in.col(k) = sign.cwiseProduct(source.col(tasks[t].pairs[group.begin + k].source - begin));
          const Eigen::MatrixXd& C = here.translation(group.code);
          panel_product(C.data(), rank, rank, in.data(), rank, pairs, out.data());
          sign *= tree_.factor[level];
          for (Index k = 0; k < pairs; ++k)
            local.col(tasks[t].pairs[group.begin + k].target - begin) += sign.cwiseProduct(out.col(k));
        }
      }
    });
    if (level == 2 || to_parent_[level - 1].empty()) continue;
    std::vector<Eigen::MatrixXd> shifts;
    for (const Eigen::MatrixXd& up : to_parent_[level - 1]) shifts.push_back(up.transpose());
    parallel_for(count, grain, [&](Index first, Index last) {
      for (Index k = first; k < last; ++k) {
        const TreeBox<Dim>& box = tree_.boxes[begin + k];
        unsigned corner = 0;
        for (int d = 0; d < Dim; ++d) corner |= static_cast<unsigned>(box.cell[d] % 2) << d;
        const Index parent = box.parent - tree_.level_begin[level - 1];
        const Eigen::MatrixXd& shift = shifts[corner];
        panel_product(shift.data(), rank, shift.cols(), field.local[level - 1].col(parent).data(), shift.cols(), 1,
                      local.col(k).data());
      }
    });
  }
}

template <int Dim>
FarField FastSum<Dim>::expand(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const {
  require(coefficients.size() == size(), "FastSum", "number of coefficients", coefficients.size(),
          "there must be one per centre");
  FarField field;
  field.slots = to_slots(coefficients);
  field.source.resize(tree_.levels());
  field.local.resize(tree_.levels());
  gather_sources(field);
  translate(field);
  return field;
}

// Consecutive slots together.
template <int Dim>
std::vector<typename FastSum<Dim>::Run> FastSum<Dim>::runs(const std::vector<std::int32_t>& near) const {
  std::vector<Run> result;
  for (const std::int32_t b : near)
    if (span_[b].begin < span_[b].end) result.push_back(span_[b]);
  std::sort(result.begin(), result.end(), [](const Run& a, const Run& b) { return a.begin < b.begin; });
  std::size_t kept = 0;
  for (std::size_t i = 1; i < result.size(); ++i) {
    if (result[i].begin == result[kept].end)
      result[kept].end = result[i].end;
    else
      result[++kept] = result[i];
  }
  if (!result.empty()) result.resize(kept + 1);
  return result;
}

template <int Dim>
void FastSum<Dim>::add_near(const std::vector<Run>& runs, const double* slots, const Points<Dim>& x,
                            const JetBlock& out) const {
  add_direct({Dim, position_.rows(), position_.data(), shape_.data(), false}, runs, slots, x, out);
}

template <int Dim>
void FastSum<Dim>::add_direct(const CenterArrays& centers, const std::vector<Run>& runs, const double* slots,
                              const Points<Dim>& x, const JetBlock& out) const {
  const Derivatives wanted = out.derivatives();
  thread_local RadialBatch batch;
  for (Index k = 0; k < x.cols(); ++k) {
    double* const gradient = out.gradient == nullptr ? nullptr : out.gradient + Dim * k;
    double* const hessian = out.hessian == nullptr ? nullptr : out.hessian + symmetric_size<Dim> * k;
    batch.size = batch.runs = 0;
    const auto flush = [&] {
      radial_distances(centers, x.col(k).data(), wanted >= Derivatives::gradient, batch);
      if (wanted == Derivatives::none) kernel_.values(batch.r2, batch.size, batch.phi);
      if (wanted == Derivatives::gradient) kernel_.gradients(batch.r2, batch.size, batch.phi, batch.g);
      if (wanted == Derivatives::hessian) kernel_.hessians(batch.r2, batch.size, batch.phi, batch.g, batch.h);
      add_radial_sums(centers, slots, batch, out.value + k, gradient, hessian);
      batch.size = batch.runs = 0;
    };
    for (const Run& run : runs) {
      for (Index begin = run.begin; begin < run.end;) {
        const Index length = std::min(run.end - begin, RadialBatch::capacity - batch.size);
        batch.slot[batch.runs] = begin;
        batch.length[batch.runs++] = length;
        batch.size += length;
        begin += length;
        if (batch.size == RadialBatch::capacity) flush();
      }
    }
    if (batch.size > 0) flush();
  }
}

template <int Dim>
void FastSum<Dim>::add_local(const FarField& field, Index b, const Points<Dim>& x, const JetBlock& out) const {
  const TreeBox<Dim>& box = tree_.boxes[b];
  if (box.level < 2 || field.local[box.level].size() == 0) return;
  const BoxOperators<Dim>& level = *tree_.operators[box.level];
  const Index n = x.cols(), slab = level.slab(), nodes = level.basis().rows();
  const int order = level.chebyshev().order();
  const double half = tree_.half(box.level);
  Eigen::VectorXd nodal = Eigen::VectorXd::Zero(nodes);
  panel_product(level.basis().data(), nodes, level.rank(),
                field.local[box.level].col(b - tree_.level_begin[box.level]).data(), level.rank(), 1, nodal.data());
  const int derivatives = static_cast<int>(out.derivatives());
  const NodalProducts<Dim> products(level, (x.colwise() - tree_.center(box)) / half, derivatives);
  std::array<Eigen::MatrixXd, 3> along_first;  // sums over the first axis, for each derivative
  for (int d = 0; d <= derivatives; ++d) {
    const Eigen::MatrixXd first = products.first(d).transpose();
    along_first[d].setZero(slab, n);
    panel_product(nodal.data(), slab, order, first.data(), order, n, along_first[d].data());
  }
  const auto sums = [&](std::array<int, 3> d) -> Eigen::RowVectorXd {
    return along_first[d[0]].cwiseProduct(products.others(d)).colwise().sum();
  };
  Eigen::Map<Eigen::RowVectorXd>(out.value, n) += sums({});
  for (int a = 0, entry = 0; a < Dim; ++a) {
    std::array<int, 3> d{};
    d[a] = 1;
    if (derivatives >= 1) Eigen::Map<Points<Dim>>(out.gradient, Dim, n).row(a) += sums(d) / half;
    for (int c = a; derivatives >= 2 && c < Dim; ++c, ++entry) {
      std::array<int, 3> e = d;
      ++e[c];
      using Triangles = Eigen::Matrix<double, symmetric_size<Dim>, Eigen::Dynamic>;
      Eigen::Map<Triangles>(out.hessian, symmetric_size<Dim>, n).row(entry) += sums(e) / (half * half);
    }
  }
}

template <int Dim>
void FastSum<Dim>::sum_leaf(const FarField& field, Index leaf, const Points<Dim>& x, const JetBlock& out) const {
  add_near(runs(tree_.boxes[leaf].near), field.slots.data(), x, out);
  add_local(field, leaf, x, out);
}

template <int Dim>
Eigen::VectorXd FastSum<Dim>::multiply(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const {
  const FarField field = expand(coefficients);
  Eigen::VectorXd result(size());
  parallel_for(std::ssize(tree_.boxes), grain, [&](Index begin, Index end) {
    for (Index b = begin; b < end; ++b) {
      const TreeBox<Dim>& box = tree_.boxes[b];
      if (box.count == 0 || !box.leaf()) continue;
      Eigen::VectorXd values = Eigen::VectorXd::Zero(box.count);
      sum_leaf(field, b, points_of(box), {values.data()});
      for (Index k = 0; k < box.count; ++k) result[tree_.order[box.first + k]] = values[k];
    }
  });
  return result;
}

// Outside of the cube: boxes at least their own size away by their nodes, points of the others.
template <int Dim>
void FastSum<Dim>::add_outside(const FarField& field, const Points<Dim>& x, const JetBlock& out) const {
  std::vector<std::int32_t> open = {0};
  while (!open.empty()) {
    const Index b = open.back();
    const TreeBox<Dim>& box = tree_.boxes[b];
    open.pop_back();
    if (box.count == 0) continue;
    if (tree_.few(box)) {
      add_near(runs({static_cast<std::int32_t>(b)}), field.slots.data(), x, out);
      continue;
    }
    const double half = tree_.half(box.level);
    const Point<Dim> center = tree_.center(box);
    const bool apart = (x.col(0) - center).cwiseAbs().maxCoeff() >= 3 * half;
    if (!apart || box.level < 2 || field.source[box.level].size() == 0) {
      for (const std::int32_t child : box.child)
        if (child >= 0) open.push_back(child);
      continue;
    }
    const BoxOperators<Dim>& level = *tree_.operators[box.level];
    Eigen::VectorXd weights = level.basis() * field.source[box.level].col(b - tree_.level_begin[box.level]);
    const Eigen::MatrixXd position = (half * level.nodes()).colwise() + center;
    const Eigen::MatrixXd by_axis = position.transpose();
    const Eigen::VectorXd shape = Eigen::VectorXd::Constant(weights.size(), 1 / (support_ * support_));
    add_direct({Dim, weights.size(), by_axis.data(), shape.data(), false}, {{0, weights.size()}}, weights.data(), x,
               out);
  }
}

template <int Dim>
void FastSum<Dim>::add_sums(const FarField& field, const PointsRef<Dim>& x, const JetBlock& out) const {
  std::vector<std::pair<Index, Index>> leaf_of(x.cols());
  for (Index k = 0; k < x.cols(); ++k) leaf_of[k] = {tree_.leaf_at(x.col(k)), k};
  std::sort(leaf_of.begin(), leaf_of.end());
  Jet<Dim> jet;
  for (std::size_t begin = 0; begin < leaf_of.size();) {
    const Index leaf = leaf_of[begin].first;
    std::size_t end = begin + 1;
    while (leaf >= 0 && end < leaf_of.size() && leaf_of[end].first == leaf) ++end;
    Points<Dim> some(Dim, end - begin);
    for (std::size_t k = begin; k < end; ++k) some.col(k - begin) = x.col(leaf_of[k].second);
    jet = Jet<Dim>(some.cols(), out.derivatives());
    jet.value.setZero();
    jet.gradient.setZero();
    jet.hessian.setZero();
    const JetBlock sums{jet.value.data(), out.gradient != nullptr ? jet.gradient.data() : nullptr,
                        out.hessian != nullptr ? jet.hessian.data() : nullptr};
    if (leaf >= 0)
      sum_leaf(field, leaf, some, sums);
    else
      add_outside(field, some, sums);
    for (std::size_t k = begin; k < end; ++k) {
      const Index at = leaf_of[k].second;
      out.value[at] += jet.value[k - begin];
      if (out.gradient != nullptr) Eigen::Map<Point<Dim>>(out.gradient + Dim * at) += jet.gradient.col(k - begin);
      if (out.hessian == nullptr) continue;
      for (int e = 0; e < symmetric_size<Dim>; ++e)
        out.hessian[symmetric_size<Dim> * at + e] += jet.hessian(e, k - begin);
    }
    begin = end;
  }
}

template class FastSum<1>;
template class FastSum<2>;
template class FastSum<3>;

}  // namespace csrbf
