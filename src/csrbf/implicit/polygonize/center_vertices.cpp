#include "csrbf/implicit/polygonize/center_vertices.hpp"

#include "csrbf/implicit/polygonize/edge_vertices.hpp"

namespace csrbf::polygonization {
namespace {

// Chosen by hand.
constexpr int newton_steps = 3;         // converges quadratically
constexpr double range = 0.25;          // largest displacement, in shortest sides of a cell: keeps vertices in place
constexpr double short_step = 1e-3;     // in the same unit; the error after such a step is about its square ...
constexpr double smooth_step = 0.01;    // ... and so may the first be on smooth surfaces; at creases it may be as large
constexpr Index slice = 1 << 16;        // vertices moved together; more: memory, fewer: steps with few of them
constexpr double same_normal = 0.95;    // cosine of 18 degrees: a normal that differs by less replaces the present one
constexpr double smooth_normal = 0.99;  // cosine of 8 degrees: the mean normal around a vertex of a smooth surface

struct Moving {
  Index vertex;
  Point<3> start;
  Point<3> best;  // where |f| was least
  double value;   // |f| there
};

// Processes f and its gradient at a vertex and moves the vertex. Returns whether another step is needed.
bool advance(Moving& moving, double f, const Point<3>& gradient, double cell, bool last, Mesh& mesh) {
  auto vertex = mesh.vertices.col(moving.vertex);
  if (!(std::abs(f) < moving.value)) {
    vertex = moving.best;
    return false;
  }
  const bool first = std::isinf(moving.value);
  moving.value = std::abs(f);
  moving.best = vertex;
  bool smooth = false;
  if (mesh.normals.cols() > 0) {
    const Point<3> normal = outward_normal(gradient), known = mesh.normals.col(moving.vertex);
    smooth = first && normal.dot(known) > smooth_normal;
    if (known.isZero() || normal.dot(known) > same_normal) mesh.normals.col(moving.vertex) = normal;
  }
  const double slope = gradient.norm();
  const Point<3> step = -f / slope * (gradient / slope);
  if (last || !step.allFinite()) return false;
  const Point<3> shift = moving.best + step - moving.start;
  vertex = moving.start + std::min(1.0, range * cell / shift.norm()) * shift;
  return !(step.norm() <= (smooth ? smooth_step : short_step) * cell);
}

}  // namespace

void place_center_vertices(const CellLattice& lattice, LevelSampler& sampler, Index first, bool refine, Mesh& mesh) {
  if (!refine && mesh.normals.cols() == 0) return;
  const double cell = lattice.spacing.minCoeff();
  const Box<3> capped = lattice.capped_box();
  const Box<3> sampled{lattice.position(Cell::Ones()), lattice.position(lattice.cells - 1)};
  std::vector<Moving> open;
  for (Index begin = first; begin < mesh.vertices.cols(); begin += slice) {
    open.clear();
    for (Index v = begin; v < std::min(begin + slice, mesh.vertices.cols()); ++v)
      if (sampled.contains(mesh.vertices.col(v)))
        open.push_back({v, mesh.vertices.col(v), mesh.vertices.col(v), std::numeric_limits<double>::infinity()});
    for (int step = 0; step <= newton_steps && !open.empty(); ++step) {
      Points<3> points(3, std::ssize(open));
      for (Index i = 0; i < points.cols(); ++i) points.col(i) = mesh.vertices.col(open[i].vertex);
      const Jet<3> jet = sampler.jet(points);
      Index kept = 0;
      for (Index i = 0; i < points.cols(); ++i) {
        const Index v = open[i].vertex;
        if (advance(open[i], jet.value[i], jet.gradient.col(i), cell, !refine || step == newton_steps, mesh))
          open[kept++] = open[i];
        mesh.vertices.col(v) = mesh.vertices.col(v).cwiseMax(capped.lo).cwiseMin(capped.hi);
      }
      open.resize(kept);
    }
  }
}

}  // namespace csrbf::polygonization
