#include "csrbf/implicit/polygonize/edge_vertices.hpp"

#include "csrbf/core/parallel.hpp"

#include <utility>

namespace csrbf::polygonization {
namespace {

// Chosen by hand.
constexpr double step_tolerance = 1e-4;     // of an edge; the error after a step of this length is far smaller
constexpr double longest_last_step = 0.05;  // of an edge: the normal is that of the point before the last step
constexpr double slow_bracket = 0.51;       // of its width before: more than a bisection leaves, however it is rounded
constexpr int most_evaluations = 12;        // for each edge; most need one
constexpr Index edge_bricks = 32;           // large enough to hide the cost of a task
constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

// The root t of the field along one edge of unit length, with a bracket lo < t < hi.
struct EdgeRoot {
  int vertex;
  Point<3> corner;
  Point<3> edge;  // to the other corner
  double t, lo, hi, f_lo, f_hi;
};

// Root of f + slope s + c s^2 between 0 and `end`, where the parabola has the value f_end of the opposite sign.
double parabola_root(double f, double slope, double end, double f_end) {
  const double c = ((f_end - f) / end - slope) / end;
  const double root_of_discriminant = std::sqrt(std::max(0.0, slope * slope - 4 * c * f));
  const double q = -0.5 * (slope + std::copysign(root_of_discriminant, slope));
  const double near = f / q;
  return near * end >= 0 && std::abs(near) <= std::abs(end) ? near : q / c;
}

// Processes the value and slope at t and moves t to the next estimate. Returns whether it has converged.
bool advance_root(EdgeRoot& root, double f, double slope, bool may_bisect) {
  const double width = root.hi - root.lo;
  if (!std::isfinite(slope)) {
    const double below = (f - root.f_lo) / (root.t - root.lo);
    const double above = (root.f_hi - f) / (root.hi - root.t);
    slope = below + (above - below) * (root.t - root.lo) / width;
  }
  const bool root_is_above = (f >= 0) == (root.f_lo >= 0);
  const double end = (root_is_above ? root.hi : root.lo) - root.t;
  const double secant = -f * end / ((root_is_above ? root.f_hi : root.f_lo) - f);
  double step = parabola_root(f, slope, end, root_is_above ? root.f_hi : root.f_lo);
  if (!(step * end >= 0 && std::abs(step) <= std::abs(end))) step = std::isfinite(secant) ? secant : 0.5 * end;
  const double newton = -f / slope;
  (root_is_above ? root.lo : root.hi) = root.t;
  (root_is_above ? root.f_lo : root.f_hi) = f;

  const bool settled = std::abs(step) <= step_tolerance ||
                       (std::abs(step) <= longest_last_step && std::abs(step - newton) <= step_tolerance);
  root.t += step;
  if (!settled && may_bisect && root.hi - root.lo > slow_bracket * width) root.t = 0.5 * (root.lo + root.hi);
  return settled;
}

// Places the vertices of up to Field::block_size edges at a time, on the calling thread.
class EdgeBlock {
 public:
  EdgeBlock(const CellLattice& lattice, LevelSampler& sampler, const VertexDemand& demand, Mesh& mesh)
      : lattice_(lattice), sampler_(sampler), demand_(demand), mesh_(mesh) {
    roots_.reserve(capacity);
  }

  void add(const EdgeRoot& root) {
    roots_.push_back(root);
    if (roots_.size() == capacity) flush();
  }

  void flush() {
    if (roots_.empty()) return;
    open_.clear();
    for (EdgeRoot& root : roots_) open_.push_back(&root);
    if (demand_.refine) {
      solve();
    } else if (demand_.normals) {
      sample(true);
      for (Index i = 0; i < std::ssize(open_); ++i)
        mesh_.normals.col(open_[i]->vertex) = outward_normal(gradient_.col(i));
    }
    for (EdgeRoot& root : roots_) {
      root.t = std::clamp(root.t, edge_margin, 1 - edge_margin);
      mesh_.vertices.col(root.vertex) = position(root);
    }
    if (demand_.refine) settle_near_corners();
    roots_.clear();
  }

 private:
  static constexpr std::size_t capacity = Field<3>::block_size;

  [[nodiscard]] Point<3> position(const EdgeRoot& root) const { return root.corner + root.t * root.edge; }

  // The field at the current estimates of the open roots.
  void sample(bool gradient) {
    const auto n = std::ssize(open_);
    for (Index i = 0; i < n; ++i) points_.col(i) = position(*open_[i]);
    sampler_.sample_block(points_.leftCols(n), value_.data(), gradient ? gradient_.data() : nullptr);
  }

  void solve() {
    for (int evaluation = 0; evaluation < most_evaluations && !open_.empty(); ++evaluation) {
      sample(demand_.normals);
      Index kept = 0;
      for (Index i = 0; i < std::ssize(open_); ++i) {
        EdgeRoot& root = *open_[i];
        double slope = not_known;
        if (demand_.normals) {
          const Point<3> gradient = gradient_.col(i);
          mesh_.normals.col(root.vertex) = outward_normal(gradient);
          slope = gradient.dot(root.edge);
        }
        if (!advance_root(root, value_[i], slope, evaluation > 0)) open_[kept++] = &root;
      }
      open_.resize(kept);
    }
  }

  // Vertices clamped to the margin of their edge move onto the surface along the gradient.
  void settle_near_corners() {
    open_.clear();
    for (EdgeRoot& root : roots_)
      if (root.t == edge_margin || root.t == 1 - edge_margin) open_.push_back(&root);
    if (open_.empty()) return;
    sample(true);
    const double longest = 2 * edge_margin * lattice_.spacing.minCoeff();
    for (Index i = 0; i < std::ssize(open_); ++i) {
      const Point<3> gradient = gradient_.col(i);
      const double slope = gradient.norm(), step = -value_[i] / slope;
      if (slope > 0 && std::abs(step) <= longest) mesh_.vertices.col(open_[i]->vertex) += step * (gradient / slope);
      if (demand_.normals) mesh_.normals.col(open_[i]->vertex) = outward_normal(gradient);
    }
  }

  const CellLattice& lattice_;
  LevelSampler& sampler_;
  VertexDemand demand_;
  Mesh& mesh_;
  std::vector<EdgeRoot> roots_;
  std::vector<EdgeRoot*> open_;
  Points<3> points_{3, capacity};
  Eigen::VectorXd value_{capacity};
  Points<3> gradient_{3, capacity};
};

// Places a vertex of the cap. Returns false for an edge whose ends were both sampled.
bool place_on_cap(const CellLattice& lattice, const Cell& lower, int d, int vertex, bool normals, Mesh& mesh) {
  const Cell upper = lower + offset(d);
  const bool at_lower = lattice.on_boundary(lower);
  if (!at_lower && !lattice.on_boundary(upper)) return false;
  const Cell out = (upper >= lattice.cells).cast<int>() - (lower <= 0).cast<int>();
  const Point<3> inner = lattice.position(at_lower ? upper : lower);
  const Point<3> outer = lattice.position(at_lower ? lower : upper);
  mesh.vertices.col(vertex) = inner + edge_margin * (outer - inner);
  if (normals) mesh.normals.col(vertex) = out.matrix().cast<double>().normalized();
  return true;
}

void place_vertices_of_brick(const CellLattice& lattice, const Brick& brick, bool normals, Mesh& mesh,
                             EdgeBlock& block) {
  for (const int d : all_directions) {
    int vertex = brick.vertex[d];
    const Point<3> edge = lattice.spacing.cwiseProduct(offset(d).matrix().cast<double>());
    for (Mask left = brick.edges[d]; left != 0; left &= left - 1, ++vertex) {
      const int bit = std::countr_zero(left);
      const Cell corner = brick.corner(bit);
      if (place_on_cap(lattice, corner, d, vertex, normals, mesh)) continue;
      const double f_lo = brick.value[bit];
      const double f_hi = corner_at(brick, bit, d).value();
      const double secant = std::clamp(f_lo / (f_lo - f_hi), edge_margin, 1 - edge_margin);
      const CornerRef upper = corner_at(brick, bit, d);
      if (((brick.moved >> bit | upper.brick.moved >> upper.bit) & 1) != 0) {
        // The field has no root there.
        mesh.vertices.col(vertex) = lattice.position(corner) + secant * edge;
        if (normals) mesh.normals.col(vertex).setZero();
        continue;
      }
      block.add({vertex, lattice.position(corner), edge, secant, 0, 1, f_lo, f_hi});
    }
  }
}

}  // namespace

Index number_edge_vertices(const std::vector<Brick*>& bricks) {
  Index count = 0;
  for (Brick* brick : bricks) {
    for (const int d : all_directions) {
      brick->vertex[d] = static_cast<int>(count);
      count += std::popcount(brick->edges[d]);
    }
    if (count > std::numeric_limits<int>::max())
      throw SolverFailure("polygonize: more than 2^31 vertices; lower the resolution");
  }
  return count;
}

void place_edge_vertices(const CellLattice& lattice, const std::vector<Brick*>& bricks, LevelSampler& sampler,
                         const VertexDemand& demand, Mesh& mesh, const Progress& progress) {
  const auto total = std::ssize(bricks);
  const Index part = std::max<Index>(edge_bricks, total / 16 / edge_bricks * edge_bricks);
  for (Index first = 0; first < total; first += part) {
    report(progress, "polygonize", 0.8 + 0.15 * static_cast<double>(first) / static_cast<double>(total));
    const auto compute = [&](Index begin, Index end) {
      EdgeBlock block(lattice, sampler, demand, mesh);
      for (Index i = first + begin; i < first + end; ++i)
        place_vertices_of_brick(lattice, *bricks[i], demand.normals, mesh, block);
      block.flush();
    };
    parallel_for(std::min(part, total - first), edge_bricks, compute);
  }
}

}  // namespace csrbf::polygonization
