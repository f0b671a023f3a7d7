#include "csrbf/implicit/polygonize/cell_tracer.hpp"

#include "csrbf/core/parallel.hpp"

#include <utility>

namespace csrbf::polygonization {
namespace {

constexpr int cells_to_end = 3;          // from moved corners: vertices of other ranges stay what they are
constexpr Index bricks_per_range = 256;  // large enough to hide the cost of a task

// Edges of a brick that end in its neighbour at offset k.
Mask upper_ends(const Brick& brick, int k) {
  Mask edges = 0;
  for (const int d : all_directions)
    if ((d & k) == k) edges |= brick.edges[d];
  for (int axis = 0; axis < 3; ++axis)
    if (k >> axis & 1) edges &= last_layer(axis);
  return edges;
}

// The pending cells of a brick that the surface crosses, and which of their faces.
Crossings crossings_of(const Brick& brick) {
  const Octet inside = inside_corners(brick);
  Crossings crossings;
  crossings.cells = brick.pending & mixed_cells(inside);
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      crossings.faces[axis][side] = crossings.cells & mixed_faces(inside, axis, side);
  return crossings;
}

}  // namespace

void CellTracer::add(const Cell& cell) {
  queue(grid_.at(cell), Mask{1} << bit_of(cell));
}

bool CellTracer::active(const Cell& cell) const {
  const Brick* brick = grid_.find(cell);
  return brick != nullptr && (brick->active >> bit_of(cell) & 1);
}

void CellTracer::run(const Progress& progress) {
  while (!queue_.empty()) {
    begin_wave();
    sample_corners();
    visit_cells();
    ++waves_;
    report(progress, "polygonize", fraction());
  }
}

// The cells of a brick that are in the range.
Mask CellTracer::in_range(const Brick& brick) const {
  Mask all = ~Mask{0};
  for (int axis = 0; axis < 3; ++axis) {
    Mask layer = first_layer(axis);
    for (int k = 0; k < brick_side; ++k, layer <<= bit_stride(axis))
      if (brick.first[axis] + k < range_.first[axis] || brick.first[axis] + k >= range_.last[axis]) all &= ~layer;
  }
  return all;
}

std::vector<Cell> CellTracer::beyond() const {
  std::vector<Cell> cells = beyond_;
  const auto less = [](const Cell& a, const Cell& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::sort(cells.begin(), cells.end(), less);
  cells.erase(std::unique(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return (a == b).all(); }),
              cells.end());
  return cells;
}

void CellTracer::run_from(const std::vector<Cell>& starts, const Progress& progress) {
  for (const Cell& cell : starts) add(cell);
  run(progress);
  for (const Cell& cell : starts)
    for (int k = 0; k < 27 && !active(cell); ++k) {
      const Cell neighbour = cell + Cell(k % 3, k / 3 % 3, k / 9) - 1;
      if (range_.contains(neighbour)) add(neighbour);
    }
  run(progress);
}

// Its value becomes `persistence` beyond the level, so that the surface runs between it and its former neighbours. The
// cells around it are visited again.
void CellTracer::move_to_other_side(const BrickCorner& corner, double persistence) {
  Brick& brick = *corner.brick;
  const Mask bit = Mask{1} << corner.bit;
  double& value = brick.value[corner.bit];
  value = (brick.inside & bit) != 0 ? -persistence : persistence;
  brick.inside ^= bit;
  brick.moved ^= bit;
  for (int k = 0; k < 8; ++k) {
    const Cell cell = brick.corner(corner.bit) - offset(k);
    Brick& holder = grid_.at(cell);
    const Mask cell_bit = Mask{1} << bit_of(cell);
    if ((holder.active & cell_bit) != 0) --active_cells_;
    holder.active &= ~cell_bit;
    holder.visited &= ~cell_bit;
    queue(holder, cell_bit);
  }
}

Index CellTracer::remove_weak_features(double persistence, const Progress& progress) {
  const std::vector<Brick*> doubtful = doubtful_bricks(grid_, persistence);
  Index count = 0;
  for (const bool inside : {true, false}) {
    for (const std::vector<BrickCorner>& bridge : weak_bridges(grid_, doubtful, inside, persistence)) {
      const bool movable = std::all_of(bridge.begin(), bridge.end(), [&](const BrickCorner& corner) {
        const Cell cell = corner.brick->corner(corner.bit);
        return (cell >= range_.first + cells_to_end).all() && (cell <= range_.last - cells_to_end).all();
      });
      if (!movable) continue;
      for (const BrickCorner& corner : bridge) move_to_other_side(corner, persistence);
      ++count;
    }
    run(progress);
  }
  return count;
}

void CellTracer::queue(Brick& brick, Mask cells) {
  cells &= ~(brick.visited | brick.pending);
  if (const Mask outside = cells & ~in_range(brick); outside != 0) {
    for (Mask left = outside; left != 0; left &= left - 1) beyond_.push_back(brick.corner(std::countr_zero(left)));
    cells &= ~outside;
  }
  if (cells == 0) return;
  if (brick.queued == 0) queue_.push_back(&brick);
  brick.queued |= cells;
}

void CellTracer::begin_wave() {
  std::swap(front_, queue_);
  queue_.clear();
  sort_along_curve(front_);
  for (Brick* brick : front_) brick->pending = std::exchange(brick->queued, 0);
}

void CellTracer::sample_corners() {
  sampled_.clear();
  for (Brick* brick : front_) {
    Octet needed{brick->pending};
    for (int axis = 0; axis < 3; ++axis) dilate(needed, axis);
    for (int k = 0; k < 8; ++k) {
      if (needed[k] == 0) continue;
      Brick& holder = grid_.upper(*brick, k);
      const Mask fresh = needed[k] & ~(holder.known | holder.needed);
      if (fresh == 0) continue;
      if (holder.needed == 0) sampled_.push_back(&holder);
      holder.needed |= fresh;
    }
  }
  sort_along_curve(sampled_);

  // Not resized: Eigen 3.4 would free the old ones a second time where memory for the new ones is lacking.
  const Index most = 64 * std::min(slice_bricks, std::ssize(sampled_));
  if (points_.cols() < most) points_ = Points<3>(3, most);
  const std::span<Brick*> bricks(sampled_);
  for (std::size_t done = 0; done < bricks.size(); done += slice_bricks)
    sample(bricks.subspan(done, std::min<std::size_t>(slice_bricks, bricks.size() - done)));
}

// Samples the needed corners of some bricks in one batch.
void CellTracer::sample(std::span<Brick*> bricks) {
  Index count = 0;
  for (const Brick* brick : bricks)
    for (Mask left = brick->needed; left != 0; left &= left - 1)
      points_.col(count++) = grid_.lattice().position(brick->corner(std::countr_zero(left)));
  const Eigen::VectorXd values = sampler_.values(points_.leftCols(count));

  Index next = 0;
  for (Brick* brick : bricks) {
    for (Mask left = brick->needed; left != 0; left &= left - 1) {
      const int bit = std::countr_zero(left);
      brick->value[bit] = values[next++];
      if (brick->value[bit] >= 0) brick->inside |= Mask{1} << bit;
    }
    brick->known |= std::exchange(brick->needed, 0);
  }
}

void CellTracer::visit_cells() {
  const auto count = std::ssize(front_);
  std::vector<Crossings> crossings(front_.size());
  const auto compute = [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) crossings[i] = crossings_of(*front_[i]);
  };
  parallel_for(count, bricks_per_range, compute);
  for (std::size_t i = 0; i < front_.size(); ++i) {
    Brick& brick = *front_[i];
    brick.visited |= std::exchange(brick.pending, 0);
    brick.active |= crossings[i].cells;
    active_cells_ += std::popcount(crossings[i].cells);
    if (crossings[i].cells != 0) push_across_faces(brick, crossings[i].faces);
  }
}

void CellTracer::push_across_faces(Brick& brick, const Faces& faces) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto [down, up] = faces[axis];
    queue(brick, moved_up(up, axis));
    if (const Mask carried = carried_up(up, axis)) queue(grid_.upper(brick, 1 << axis), carried);
    queue(brick, moved_down(down, axis));
    if (const Mask carried = carried_down(down, axis)) queue(grid_.lower(brick, axis), carried);
  }
}

std::vector<Brick*> CellTracer::finish(std::span<const int> directions) {
  std::vector<Brick*> bricks = grid_.sorted();
  for (const Brick* brick : bricks) {
    for (const int d : directions) {
      Octet edges{brick->active};
      for (int axis = 0; axis < 3; ++axis)
        if ((d >> axis & 1) == 0) dilate(edges, axis);
      for (int k = 0; k < 8; ++k)
        if (edges[k] != 0) brick->upper[k]->edges[d] |= edges[k];
    }
  }
  for (Brick* brick : bricks) {
    for (int k = 1; k < 8; ++k)
      if (upper_ends(*brick, k) != 0) grid_.upper(*brick, k);
    const Octet inside = inside_corners(*brick);
    for (const int d : directions) brick->edges[d] &= brick->inside ^ inside[d];
  }
  return bricks;
}

// The surface has about as many cells as the faces of its bounding box. The exact number is unknown in advance, so the
// estimate only tends to the 0.8 at which the vertices take over.
double CellTracer::fraction() const {
  const Eigen::Array3d n = grid_.lattice().cells.cast<double>();
  const double expected = 2 * (n[0] * n[1] + n[1] * n[2] + n[2] * n[0]);
  return 0.8 * static_cast<double>(active_cells_) / (static_cast<double>(active_cells_) + expected);
}

}  // namespace csrbf::polygonization
