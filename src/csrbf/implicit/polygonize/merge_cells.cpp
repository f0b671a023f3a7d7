#include "csrbf/implicit/polygonize/merge_cells.hpp"

#include "csrbf/implicit/mesh/edge_collapse.hpp"

#include <bit>

namespace csrbf::polygonization {
namespace {

// On a spherical patch, the distance of chords of its width from it over the root mean square distance of the best
// point from its tangent planes.
constexpr double chord_error = 4;

constexpr int vertices_per_report = 1 << 15;  // between two progress reports

class CellMerger {
 public:
  CellMerger(const CellLattice& lattice, double tolerance, std::vector<CellPlanes> planes, Mesh& mesh)
      : lattice_(lattice),
        tolerance_(tolerance),
        planes_(std::move(planes)),
        mesh_(mesh),
        collapser_(mesh),
        merged_at_(planes_.size()) {}

  void merge(const Progress& progress) {
    const auto levels = static_cast<int>(std::bit_width(static_cast<unsigned>(lattice_.cells.maxCoeff())));
    for (int level = 1; level <= levels; ++level) {
      for (int v = 0; v < static_cast<int>(planes_.size()); ++v) {
        if (v % vertices_per_report == 0) report(progress, "polygonize", 0.95);
        while (merge_one_into(v, level)) {
        }
      }
    }
    collapser_.finish();
  }

 private:
  [[nodiscard]] bool share_cube(int u, int v, int level) const {
    return ((planes_[u].cell / (1 << level)) == (planes_[v].cell / (1 << level))).all();
  }

  // Merges the first suitable vertex into u.
  bool merge_one_into(int u, int level) {
    const std::vector<int> around = collapser_.neighbours(u);
    return std::any_of(around.begin(), around.end(), [&](int v) {
      if (!share_cube(u, v, level)) return false;
      // Tried before, and nothing changed since?
      if (share_cube(u, v, level - 1) && std::max(merged_at_[u], merged_at_[v]) < level - 1) return false;
      return merge_pair(u, v, level);
    });
  }

  bool merge_pair(int u, int v, int level) {
    Quadric sum = planes_[u].planes;
    sum += planes_[v].planes;
    const Cell cube = planes_[u].cell / (1 << level) * (1 << level);
    Box<3> room = room_for_vertices(lattice_, lattice_.position(cube), 1 << level);
    room.lo -= lattice_.origin;
    room.hi -= lattice_.origin;
    const Point<3> p = sum.minimizer(room);
    if (!(chord_error * sum.distance(p) <= tolerance_) || !collapser_.collapse(u, v, lattice_.origin + p)) return false;
    planes_[u].planes = sum;
    merged_at_[u] = level;
    if (mesh_.normals.cols() > 0)
      mesh_.normals.col(u) = (mesh_.normals.col(u) + mesh_.normals.col(v)).stableNormalized();
    return true;
  }

  const CellLattice& lattice_;
  double tolerance_;
  std::vector<CellPlanes> planes_;
  Mesh& mesh_;
  EdgeCollapser collapser_;
  std::vector<int> merged_at_;  // level
};

}  // namespace

void merge_cells(const CellLattice& lattice, double tolerance, std::vector<CellPlanes> planes, Mesh& mesh,
                 const Progress& progress) {
  CellMerger(lattice, tolerance, std::move(planes), mesh).merge(progress);
}

}  // namespace csrbf::polygonization
