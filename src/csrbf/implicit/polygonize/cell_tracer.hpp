#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/implicit/polygonize/brick_grid.hpp"
#include "csrbf/implicit/polygonize/level_sampler.hpp"
#include "csrbf/implicit/polygonize/weak_features.hpp"

#include <bit>

namespace csrbf::polygonization {

/// Cells of a brick whose lower and upper faces across each axis the surface crosses.
using Faces = std::array<std::array<Mask, 2>, 3>;

/// Cells of a brick that the surface crosses.
struct Crossings {
  Mask cells = 0;
  Faces faces{};
};

/// Follows a surface from cell to cell, across the faces it crosses, in waves. Every corner of a visited cell is
/// sampled once, the new corners of a wave in large batches along the Morton curve of the bricks. Time and memory are
/// proportional to the number of cells visited.
class CellTracer {
 public:
  CellTracer(const CellLattice& lattice, LevelSampler& sampler)
      : CellTracer(lattice, {Cell::Zero(), lattice.cells}, sampler) {}
  /// Visits the cells of the range only.
  CellTracer(const CellLattice& lattice, const CellRange& range, LevelSampler& sampler)
      : grid_(lattice), range_(range), sampler_(sampler) {}

  /// Queues a cell of the range.
  void add(const Cell& cell);

  /// Visits queued cells and all those connected to them across faces that the surface crosses. Reports progress after
  /// every wave.
  void run(const Progress& progress);

  /// The same from some cells of the range, and from the neighbours of those that are not crossed.
  void run_from(const std::vector<Cell>& starts, const Progress& progress);

  /// Cuts bridges and fills holes that are gone where the level moves by less than `persistence`, by moving corners to
  /// the other side, but none near the ends of the range. Returns the number of bridges and holes.
  Index remove_weak_features(double persistence, const Progress& progress);

  /// Whether a cell was visited and is crossed by the surface.
  [[nodiscard]] bool active(const Cell& cell) const;

  /// Calls visit(cell) for the visited cells that the surface crosses, along the Morton curve of their bricks.
  template <class Visit>
  void for_each_active(const Visit& visit) const {
    for (const Brick* brick : grid_.sorted())
      for (Mask left = brick->active; left != 0; left &= left - 1) visit(brick->corner(std::countr_zero(left)));
  }

  /// Cells beyond the range that the surface enters from visited ones, each once.
  [[nodiscard]] std::vector<Cell> beyond() const;

  /// Marks the crossed edges of the active cells in the given directions, and links each brick to the neighbours that
  /// hold their upper ends; nothing may be added afterwards. Returns all bricks along the curve.
  std::vector<Brick*> finish(std::span<const int> directions);

  [[nodiscard]] Index active_cells() const { return active_cells_; }
  [[nodiscard]] Index waves() const { return waves_; }

 private:
  static constexpr Index slice_bricks = 4096;  // bricks whose corners are sampled at a time: bounds memory

  void queue(Brick& brick, Mask cells);
  void move_to_other_side(const BrickCorner& corner, double persistence);
  void begin_wave();
  void sample_corners();
  void sample(std::span<Brick*> bricks);
  void visit_cells();
  void push_across_faces(Brick& brick, const Faces& faces);
  [[nodiscard]] double fraction() const;

  [[nodiscard]] Mask in_range(const Brick& brick) const;

  BrickGrid grid_;
  CellRange range_;
  LevelSampler& sampler_;
  std::vector<Brick*> queue_;    // bricks with queued cells
  std::vector<Brick*> front_;    // bricks with pending cells
  std::vector<Brick*> sampled_;  // bricks with needed corners
  Points<3> points_{3, 0};       // of a batch; a member to reuse its memory
  std::vector<Cell> beyond_;     // the range, where the surface goes on
  Index active_cells_ = 0;
  Index waves_ = 0;
};

}  // namespace csrbf::polygonization
