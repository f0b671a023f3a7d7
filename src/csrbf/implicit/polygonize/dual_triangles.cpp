#include "csrbf/implicit/polygonize/dual_triangles.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/mesh/triangle_geometry.hpp"
#include "csrbf/implicit/polygonize/cell_loops.hpp"

namespace csrbf::polygonization {
namespace {

constexpr Index quads_per_range = 4096;  // large enough to hide the cost of a task
// Chosen by hand.
constexpr double equal_distance = 1e-3;  // of the shorter diagonal: distances from the crossing that count as equal
constexpr double sliver = 0.05;          // twice the area over the square of the longest side: below, normals are noise
constexpr int unfolding_rounds = 3;      // the last one moves vertices all the way
constexpr double quad_tie = 1 + 1e-6;    // ratio within which diagonals differ by rounding only: the first wins

// How well two triangles fit the crossing that they should pass through.
struct Fit {
  int folded = 0;
  double squared_distance = std::numeric_limits<double>::infinity();

  void add(const Point<3>& p, const Point<3>& normal, const Point<3>& a, const Point<3>& b, const Point<3>& c) {
    folded += area_vector(a, b, c).dot(normal) < 0;
    squared_distance = std::min(squared_distance, closest_on_triangle(p, a, b, c).squared_distance);
  }
};

// Whether the diagonal 0 2 is better than 1 3.
bool first_diagonal(const std::array<Point<3>, 4>& q, const Point<3>& crossing, const Point<3>& normal) {
  Fit first, second;
  first.add(crossing, normal, q[0], q[1], q[2]);
  first.add(crossing, normal, q[0], q[2], q[3]);
  second.add(crossing, normal, q[0], q[1], q[3]);
  second.add(crossing, normal, q[1], q[2], q[3]);
  if (first.folded != second.folded) return first.folded < second.folded;
  const double length_first = (q[0] - q[2]).norm(), length_second = (q[1] - q[3]).norm();
  const double advantage = std::sqrt(second.squared_distance) - std::sqrt(first.squared_distance);
  if (std::abs(advantage) > equal_distance * std::min(length_first, length_second)) return advantage > 0;
  return length_first <= length_second * quad_tie;
}

// The two triangles of a quad.
std::array<Eigen::Vector3i, 2> cut_quad(const Quads& quads, Index e, const Mesh& crossings, const Mesh& mesh) {
  const Eigen::Vector4i v = quads.col(e);
  std::array<Point<3>, 4> q;
  for (int i = 0; i < 4; ++i) q[i] = mesh.vertices.col(v[i]);
  if (first_diagonal(q, crossings.vertices.col(e), crossings.normals.col(e)))
    return {Eigen::Vector3i(v[0], v[1], v[2]), Eigen::Vector3i(v[0], v[2], v[3])};
  return {Eigen::Vector3i(v[0], v[1], v[3]), Eigen::Vector3i(v[1], v[2], v[3])};
}

// Whether a triangle faces inward, judged by the normals of its vertices. Slivers do not count.
bool is_folded(const Eigen::Vector3i& v, const Mesh& mesh) {
  const Point<3> a = mesh.vertices.col(v[0]), b = mesh.vertices.col(v[1]), c = mesh.vertices.col(v[2]);
  const Point<3> area = area_vector(a, b, c);
  const double longest = std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()});
  const Point<3> normal = mesh.normals.col(v[0]) + mesh.normals.col(v[1]) + mesh.normals.col(v[2]);
  return area.norm() > sliver * longest && area.dot(normal) < 0;
}

// Whether some triangle on corners of a quad may be folded.
bool may_fold(const Eigen::Vector4i& v, const Mesh& mesh) {
  std::array<Point<3>, 4> q, n;
  for (int i = 0; i < 4; ++i) {
    q[i] = mesh.vertices.col(v[i]);
    n[i] = mesh.normals.col(v[i]);
  }
  for (int i = 0; i < 4; ++i) {
    const int j = (i + 1) % 4, k = (i + 2) % 4;
    if (area_vector(q[i], q[j], q[k]).dot(n[i] + n[j] + n[k]) < 0) return true;
  }
  return false;
}

// The loose vertices of folded triangles.
std::vector<char> folded_vertices(const DualSurface& surface, const Mesh& crossings, const Mesh& mesh) {
  std::vector<char> folded(surface.quads.cols());
  parallel_for(surface.quads.cols(), quads_per_range, [&](Index begin, Index end) {
    for (Index e = begin; e < end; ++e) {
      if (!may_fold(surface.quads.col(e), mesh)) continue;
      for (const Eigen::Vector3i& triangle : cut_quad(surface.quads, e, crossings, mesh))
        if (is_folded(triangle, mesh)) folded[e] = 1;
    }
  });
  std::vector<char> vertices(mesh.vertices.cols());
  for (Index e = 0; e < surface.quads.cols(); ++e)
    for (int i = 0; i < 4 && folded[e]; ++i) {
      const std::int32_t v = surface.quads(i, e);
      vertices[v] = surface.loose[v];
    }
  return vertices;
}

// Triangulates a quad with vertices on its sides. The corners next to such a vertex must not be joined: another face
// has that edge.
void fill_polygon(const Quads& quads, std::span<const SideVertex> sides, Index extra, Mesh& mesh) {
  CellLoop polygon;
  std::array<int, 12> vertex;
  std::array<Point<3>, 12> point;
  std::array<bool, 12> on_side{};
  const Index e = sides.front().quad;
  const auto add = [&](int v, bool side) {
    vertex[polygon.size] = v;
    point[polygon.size] = mesh.vertices.col(v);
    on_side[polygon.size++] = side;
  };
  for (int corner = 0; corner < 4; ++corner) {
    add(quads(corner, e), false);
    for (const SideVertex& side : sides)
      if (side.side == corner) add(side.vertex, true);
  }
  const int n = polygon.size;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const bool around = (j == (i + 2) % n && on_side[(i + 1) % n]) || (i == (j + 2) % n && on_side[(j + 1) % n]);
      if (i != j && !around) polygon.chords[i] |= static_cast<std::uint16_t>(1 << j);
    }
  polygon.triangulable = true;
  std::array<LoopTriangle, 12> triangles;
  triangulate(polygon, point, triangles);
  for (int t = 0; t < polygon.triangles(); ++t) {
    const auto [a, b, c] = triangles[t];
    mesh.triangles.col(t < 2 ? 2 * e + t : extra++) << vertex[a], vertex[b], vertex[c];
  }
}

}  // namespace

void unfold_quads(const DualSurface& surface, const Mesh& crossings, Mesh& mesh) {
  for (int round = 1; round <= unfolding_rounds; ++round) {
    const std::vector<char> folded = folded_vertices(surface, crossings, mesh);
    std::vector<int> number(folded.size());  // of folded vertices, which are few
    int total = 0;
    for (std::size_t v = 0; v < folded.size(); ++v)
      if (folded[v]) number[v] = total++;
    if (total == 0) return;
    Points<3> sum = Points<3>::Zero(3, total);
    Eigen::VectorXd count = Eigen::VectorXd::Zero(total);
    for (Index e = 0; e < surface.quads.cols(); ++e)
      for (const int v : surface.quads.col(e)) {
        if (!folded[v]) continue;
        sum.col(number[v]) += crossings.vertices.col(e);
        count[number[v]] += 1;
      }
    const double share = round < unfolding_rounds ? 0.5 : 1;
    for (std::size_t v = 0; v < folded.size(); ++v) {
      if (!folded[v]) continue;
      auto vertex = mesh.vertices.col(static_cast<Index>(v));
      vertex += share * (sum.col(number[v]) / count[number[v]] - vertex);
    }
  }
}

void triangulate_quads(const DualSurface& surface, const Mesh& crossings, Mesh& mesh) {
  const Index quads = surface.quads.cols();
  const std::span<const SideVertex> all(surface.side_vertices);
  mesh.triangles.resize(3, 2 * quads + std::ssize(all));
  parallel_for(quads, quads_per_range, [&](Index begin, Index end) {
    for (Index e = begin; e < end; ++e) {
      const std::array<Eigen::Vector3i, 2> triangles = cut_quad(surface.quads, e, crossings, mesh);
      mesh.triangles.col(2 * e) = triangles[0];
      mesh.triangles.col(2 * e + 1) = triangles[1];
    }
  });
  for (std::size_t i = 0, end = 0; i < all.size(); i = end) {
    while (end < all.size() && all[end].quad == all[i].quad) ++end;
    fill_polygon(surface.quads, all.subspan(i, end - i), 2 * quads + static_cast<Index>(i), mesh);
  }
}

}  // namespace csrbf::polygonization
