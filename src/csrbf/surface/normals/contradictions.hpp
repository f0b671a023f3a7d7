#pragma once

#include "csrbf/surface/normals/neighbor_table.hpp"

namespace csrbf {

/// Tells neighbours whose normals contradict each other, because one of them is wrong, from those that face opposite
/// ways because they lie on the two sheets of a plate or gap thinner than their distance. The latter stand higher over
/// each other's tangent planes than neighbours whose normals agree: that is measured first, O(n).
class Contradictions {
 public:
  Contradictions(const Points<3>& points, const Points<3>& normals, const NeighborTable& near);

  /// Whether the points i and j have opposite normals, but lie beside each other.
  [[nodiscard]] bool between(const Points<3>& normals, Index i, Index j) const;
  /// Share of such pairs among the nearest neighbours of all points.
  [[nodiscard]] double share(const Points<3>& normals) const;
  /// How many points lie on seams: lines that a sheet crosses though its normals change sides there. Neighbours that
  /// contradict each other are then on opposite sides of a line, where on thin parts they are mixed. O(n k).
  [[nodiscard]] Index on_seams(const Points<3>& normals) const;
  /// The same with creases, around which a surface keeps its side too.
  [[nodiscard]] Index on_seams_and_creases(const Points<3>& normals) const;

  /// Whether opposite normals of neighbours are those of the two sheets of plates or gaps: then the points of one side
  /// are higher along their normals than those of the other. Wrong signs are on both. O(n k).
  [[nodiscard]] bool are_of_sheets(const Points<3>& normals) const;

  static constexpr double same_side = 0.5;  ///< cosine between normals that agree. Chosen by hand

 private:
  [[nodiscard]] double rise(const Points<3>& normals, Index i, Index j) const;
  [[nodiscard]] bool across_crease(const Points<3>& normals, Index i, Index j) const;
  [[nodiscard]] bool on_seam(const Points<3>& normals, Index i, bool creases) const;
  [[nodiscard]] Index count_seams(const Points<3>& normals, bool creases) const;

  const Points<3>& points_;
  const NeighborTable& near_;
  double largest_rise_ = 1;
};

/// Whether normals cut a sheet into pieces with long seams, which are hardly there with others that differ by signs.
bool cuts_sheet(const Points<3>& points, const NeighborTable& near, const Points<3>& normals, const Points<3>& others);

}  // namespace csrbf
