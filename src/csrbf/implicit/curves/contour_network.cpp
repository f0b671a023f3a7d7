#include "csrbf/implicit/curves/contour_network.hpp"

#include "csrbf/core/error.hpp"

namespace csrbf::contouring {
namespace {

constexpr double step_tolerance = 1e-7;  // of an edge: below the error of the arcs on smooth contours. By hand
constexpr int most_evaluations = 40;     // bisection alone needs about 24 for the tolerance
constexpr std::int32_t none = Network::none;

// One step of Newton's method, or of bisection if that leaves the bracket or hardly improves. True if converged.
bool advance(EdgeRoot& root, double value) {
  ((value >= 0) == root.starts_inside ? root.lo : root.hi) = root.t;
  double step = -value / root.gradient.dot(root.edge);
  const double next = root.t + step;
  if (!(next >= root.lo && next <= root.hi && std::abs(step) <= 0.5 * std::abs(root.last_step)))
    step = 0.5 * (root.lo + root.hi) - root.t;
  root.t += step;
  root.last_step = step;
  return std::abs(step) < step_tolerance;
}

void add_roots(const Lattice& lattice, Network& network) {
  network.vertex_on.assign(2 * lattice.value.size(), none);
  for (Index j = 0; j <= lattice.cells(1); ++j)
    for (Index i = 0; i <= lattice.cells(0); ++i)
      for (int axis = 0; axis < 2; ++axis) {
        if ((axis == 0 ? i : j) == lattice.cells(axis)) continue;
        const Index from = lattice.corner(i, j), to = axis == 0 ? from + 1 : lattice.corner(i, j + 1);
        if (lattice.inside(from) == lattice.inside(to)) continue;
        network.vertex_on[lattice.edge(from, axis)] = static_cast<std::int32_t>(network.roots.size());
        const Point<2> start = lattice.position(from);
        const double secant = lattice.value[from] / (lattice.value[from] - lattice.value[to]);
        network.roots.push_back({start, lattice.position(to) - start, lattice.inside(from), secant});
      }
}

// The segments of a cell. Its edges are numbered counter-clockwise, edge k starting at corner k; a walk around the cell
// leaves the inside at exits and enters it at entries, and segments go from an exit to an entry.
void add_segments_of_cell(const Lattice& lattice, Index i, Index j, Network& network) {
  const Index low = lattice.corner(i, j), high = lattice.corner(i, j + 1);
  const std::array<Index, 4> corner{low, low + 1, high + 1, high};
  const std::array<Index, 4> edge{lattice.edge(low, 0), lattice.edge(low + 1, 1), lattice.edge(high, 0),
                                  lattice.edge(low, 1)};
  std::array<bool, 4> inside{};
  std::size_t exit = 4, entry = 4;
  int exits = 0;
  for (std::size_t k = 0; k < 4; ++k) inside[k] = lattice.inside(corner[k]);
  for (std::size_t k = 0; k < 4; ++k) {
    if (inside[k] == inside[(k + 1) % 4]) continue;
    (inside[k] ? exit : entry) = k;
    exits += inside[k] ? 1 : 0;
  }
  const auto join = [&](std::size_t from, std::size_t to) {
    network.next[network.vertex_on[edge[from]]] = network.vertex_on[edge[to]];
  };
  if (exits == 1) join(exit, entry);
  if (exits < 2) return;
  // The bilinear interpolant has its saddle point in the cell: the corners of its sign are connected.
  std::array<double, 4> f{};
  for (std::size_t k = 0; k < 4; ++k) f[k] = lattice.value[corner[k]];
  const double saddle = (f[0] * f[2] - f[1] * f[3]) / (f[0] + f[2] - f[1] - f[3]);
  for (std::size_t k = 0; k < 4; ++k) {
    if (inside[k] && !(saddle >= 0)) join(k, (k + 3) % 4);
    if (!inside[k] && saddle >= 0) join((k + 3) % 4, k);
  }
}

// Segments along the border of the box, counter-clockwise, where it is inside.
void add_border(const Lattice& lattice, Network& network) {
  const Index nx = lattice.cells(0), ny = lattice.cells(1);
  std::vector<Index> corners, edges;
  for (Index i = 0; i < nx; ++i)
    corners.push_back(lattice.corner(i, 0)), edges.push_back(lattice.edge(corners.back(), 0));
  for (Index j = 0; j < ny; ++j)
    corners.push_back(lattice.corner(nx, j)), edges.push_back(lattice.edge(corners.back(), 1));
  for (Index i = nx; i > 0; --i)
    corners.push_back(lattice.corner(i, ny)), edges.push_back(lattice.edge(corners.back() - 1, 0));
  for (Index j = ny; j > 0; --j)
    corners.push_back(lattice.corner(0, j)), edges.push_back(lattice.edge(lattice.corner(0, j - 1), 1));
  std::vector<std::int32_t> vertex(corners.size(), none);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (!lattice.inside(corners[k])) continue;
    vertex[k] = static_cast<std::int32_t>(network.roots.size() + network.border_corners.size());
    network.border_corners.push_back(corners[k]);
  }
  network.next.resize(network.roots.size() + network.border_corners.size(), none);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const std::int32_t crossing = network.vertex_on[edges[k]];
    const std::int32_t to = vertex[(k + 1) % corners.size()];
    if (vertex[k] != none) network.next[vertex[k]] = crossing != none ? crossing : to;
    if (vertex[k] == none && to != none) network.next[crossing] = to;
  }
}

}  // namespace

void refuse(double value, const Point<2>& p) {
  std::ostringstream message;
  message << "contour_lines: the field is " << value << " at (" << p[0] << ", " << p[1]
          << "): it must be finite; fix the field or shrink the bounds";
  throw SolverFailure(message.str());
}

void solve_roots(const Field<2>& field, double level, std::vector<EdgeRoot>& roots) {
  std::vector<EdgeRoot*> open;
  open.reserve(roots.size());
  for (EdgeRoot& root : roots) open.push_back(&root);
  for (int evaluation = 0; evaluation < most_evaluations && !open.empty(); ++evaluation) {
    Points<2> x(2, std::ssize(open));
    for (Index i = 0; i < x.cols(); ++i) x.col(i) = open[i]->position();
    const Jet<2> jet = field.evaluate(x, Derivatives::gradient);
    std::size_t kept = 0;
    for (Index i = 0; i < x.cols(); ++i) {
      EdgeRoot& root = *open[i];
      const double value = jet.value[i] - level;
      if (!std::isfinite(value)) refuse(value, x.col(i));
      root.gradient = jet.gradient.col(i);
      if (!advance(root, value)) open[kept++] = &root;
    }
    open.resize(kept);
  }
}

Network make_network(const Lattice& lattice) {
  Network network;
  add_roots(lattice, network);
  add_border(lattice, network);
  for (Index j = 0; j < lattice.cells(1); ++j)
    for (Index i = 0; i < lattice.cells(0); ++i) add_segments_of_cell(lattice, i, j, network);
  return network;
}

}  // namespace csrbf::contouring
