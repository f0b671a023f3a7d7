#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/core/progress.hpp"

namespace csrbf {

/// Half-line from `origin`; `direction` has length 1.
struct Ray {
  Point<3> origin = Point<3>::Zero();
  Point<3> direction = Point<3>::UnitX();
};

/// Part of a ray in which it may meet a surface, and bounds of the field there.
struct Stretch {
  double begin = 0, end = 0;  ///< distances along the ray
  double lipschitz = 0, hessian_bound = 0;
};

/// The cells of a lattice that a surface f = 0 may cross, each with bounds of f's derivatives in it.
///
/// The lattice extends four cells beyond the field's bounds. For a field with enclosures, candidates are all cells that
/// these do not exclude (at most 64 along the longest side): no zero of f in the lattice is missed. For other fields
/// they are the cells within one cell of a polygonization of the same cell size, and bounds are estimated: twice the
/// largest second derivatives at its nearby vertices, including differences of gradients between neighbours, which
/// detect creases. From there candidates spread to adjacent cells that f and its derivatives at the centre do not
/// exclude, which finds parts of the surface too thin for the polygonization.
class CandidateCells {
 public:
  /// `resolution`: cells along the longest side of the field's bounds. `mesh`: a polygonization of the field with
  /// `finer` times as many, for fields without enclosures. Progress: stage "cells". Throws InvalidInput if the field
  /// has no bounds; Cancelled.
  CandidateCells(const Field<3>& field, int resolution, const Mesh& mesh, const Progress& progress);

  /// Chosen by hand so that every point of the surface is within one cell of the cell of a vertex.
  static constexpr double finer = 1.25;

  /// Position of a ray traversing the cells.
  struct Walk {
    bool started = false;
    double t = 0;         ///< distance along the ray ...
    Eigen::Array3i cell;  ///< ... where it enters this cell
  };

  /// The next stretch of the ray that ends before t_max; false if there is none. Stretches are consecutive and at most
  /// a few cells long.
  [[nodiscard]] bool next(const Ray& ray, double t_max, Walk& walk, Stretch& stretch) const;

  /// Whether the bounds are guaranteed.
  [[nodiscard]] bool guaranteed() const { return guaranteed_; }
  /// Side of a cell.
  [[nodiscard]] double side() const { return side_; }
  /// Number of cells that may be crossed.
  [[nodiscard]] Index size() const;

 private:
  static constexpr float unseen = -1, excluded = -2;  // slopes of cells without surface; the latter were examined
  struct Cell {
    float lipschitz = unseen, hessian_bound = 0;  // lipschitz < 0: no surface here
  };
  using Corner = Eigen::Array3i;

  [[nodiscard]] bool enter(const Ray& ray, Walk& walk) const;
  void step(const Ray& ray, int cells, Walk& walk) const;
  [[nodiscard]] Cell* find(const Corner& cell);
  [[nodiscard]] const Cell* find(const Corner& cell, bool& block_is_empty) const;
  void mark(const Corner& cell, double lipschitz, double hessian_bound);
  [[nodiscard]] Box<3> box_of(const Corner& corner, int cells) const;
  void collect_enclosed(const Field<3>& field, const Progress& progress);
  double collect_polygonized(const Field<3>& field, const Mesh& mesh);
  void spread(const Field<3>& field, double typical_slope, const Progress& progress);
  [[nodiscard]] Points<3> centers_of(const std::vector<Corner>& cells) const;
  [[nodiscard]] std::vector<Corner> candidates() const;
  std::vector<Corner> unseen_neighbors(const std::vector<Corner>& cells);

  bool guaranteed_ = false;
  Point<3> origin_;
  double side_ = 1;
  Corner cells_;                     // along each axis, a multiple of the block's side
  std::vector<std::int32_t> block_;  // of the cells of 8 x 8 x 8, its place in cells, or -1
  std::vector<Cell> cell_;
};

}  // namespace csrbf
