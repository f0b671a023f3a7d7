#include "csrbf/core/mesh.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"

#include <numeric>

namespace csrbf {
namespace {

// Corner 3 t + i of triangle t; side 3 t + i leads from corner i to the next one.
std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

// A side of a triangle as seen from the smaller of its two vertices.
struct Side {
  std::int32_t larger;  // vertex
  std::uint32_t corner;
  bool operator<(const Side& other) const {
    return larger != other.larger ? larger < other.larger : corner < other.corner;
  }
};

class Counter {
 public:
  Counter(const Mesh& mesh, Topology& result)
      : vertex_(collect_corners(mesh)),
        vertices_(static_cast<std::size_t>(mesh.vertices.cols())),
        components_(vertices_),
        fans_(vertex_.size()),
        singular_(vertices_, 0),
        result_(result) {}

  void count() {
    result_.triangles = static_cast<Index>(vertex_.size() / 3);
    collect_sides();
    for (std::size_t v = 0; v < vertices_; ++v) {
      pause_();
      count_edges_of(v);
    }
    count_vertices();
    result_.euler = result_.vertices - result_.edges + result_.triangles;
  }

 private:
  // The vertices of all triangles with three distinct ones.
  static std::vector<std::int32_t> collect_corners(const Mesh& mesh) {
    std::vector<std::int32_t> corners;
    corners.reserve(mesh.triangles.size());
    for (Index t = 0; t < mesh.triangles.cols(); ++t) {
      const auto triangle = mesh.triangles.col(t);
      for (int i = 0; i < 3; ++i)
        require(triangle[i] >= 0 && triangle[i] < mesh.vertices.cols(), "topology", "vertex index", triangle[i],
                "must be a column of mesh.vertices");
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
      corners.insert(corners.end(), triangle.data(), triangle.data() + 3);
    }
    return corners;
  }

  // Sorts the sides into buckets by their smaller vertex.
  void collect_sides() {
    const auto corners = static_cast<std::uint32_t>(vertex_.size());
    first_side_.assign(vertices_ + 1, 0);
    for (std::uint32_t c = 0; c < corners; ++c) ++first_side_[smaller_vertex(c) + 1];
    std::partial_sum(first_side_.begin(), first_side_.end(), first_side_.begin());
    sides_.resize(corners);
    std::vector<std::uint32_t> next(first_side_.begin(), first_side_.end() - 1);
    for (std::uint32_t c = 0; c < corners; ++c) {
      pause_();
      sides_[next[smaller_vertex(c)]++] = {std::max(vertex_[c], vertex_[next_corner(c)]), c};
    }
  }

  [[nodiscard]] std::size_t smaller_vertex(std::uint32_t side) const {
    return static_cast<std::size_t>(std::min(vertex_[side], vertex_[next_corner(side)]));
  }

  void count_edges_of(std::size_t smaller) {
    const auto begin = sides_.begin() + first_side_[smaller];
    const auto end = sides_.begin() + first_side_[smaller + 1];
    std::sort(begin, end);
    for (auto edge = begin; edge != end;) {
      auto next = edge;
      while (next != end && next->larger == edge->larger) ++next;
      count_edge(smaller, &*edge, next - edge);
      edge = next;
    }
  }

  // One edge and the sides that lie on it.
  void count_edge(std::size_t smaller, const Side* sides, Index triangles) {
    ++result_.edges;
    const auto larger = static_cast<std::size_t>(sides[0].larger);
    components_.unite(static_cast<std::uint32_t>(smaller), static_cast<std::uint32_t>(larger));
    if (triangles == 1) ++result_.boundary_edges;
    if (triangles > 2) {
      ++result_.nonmanifold_edges;
      singular_[smaller] = singular_[larger] = 1;
    }
    if (triangles != 2) return;
    const std::uint32_t a = sides[0].corner;
    const std::uint32_t b = sides[1].corner;
    const bool opposite = vertex_[a] != vertex_[b];
    if (!opposite) ++result_.inconsistent_edges;
    fans_.unite(a, opposite ? next_corner(b) : b);
    fans_.unite(next_corner(a), opposite ? b : next_corner(b));
  }

  // A vertex is regular when its sides join its corners into one fan and none has more than two triangles.
  void count_vertices() {
    std::vector<char> used(vertices_, 0);
    for (std::uint32_t c = 0; c < vertex_.size(); ++c) {
      pause_();
      const auto v = static_cast<std::size_t>(vertex_[c]);
      if (fans_.find(c) != c) continue;
      if (used[v]) singular_[v] = 1;
      used[v] = 1;
    }
    for (std::size_t v = 0; v < vertices_; ++v) {
      if (!used[v]) continue;
      ++result_.vertices;
      if (components_.find(static_cast<std::uint32_t>(v)) == v) ++result_.components;
      if (singular_[v]) ++result_.nonmanifold_vertices;
    }
  }

  std::vector<std::int32_t> vertex_;  // of every corner
  std::size_t vertices_;
  DisjointSets components_;  // of vertices
  DisjointSets fans_;        // of corners that share a vertex and a side there
  std::vector<char> singular_;
  std::vector<std::uint32_t> first_side_;
  std::vector<Side> sides_;
  Topology& result_;
  InterruptionPoint pause_{1U << 14};
};

}  // namespace

Topology topology(const Mesh& mesh) {
  Topology result;
  Counter(mesh, result).count();
  return result;
}

}  // namespace csrbf
