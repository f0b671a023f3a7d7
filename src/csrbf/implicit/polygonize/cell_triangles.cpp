#include "csrbf/implicit/polygonize/cell_triangles.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/polygonize/cell_loops.hpp"
#include "csrbf/implicit/polygonize/edge_vertices.hpp"

namespace csrbf::polygonization {
namespace {

constexpr Index triangle_bricks = 64;  // large enough to hide the cost of a task

// Writes the triangles of one brick and the centres of its loops, starting at given columns.
class BrickFiller {
 public:
  BrickFiller(const Brick& brick, Mesh& mesh, Index triangle, Index center)
      : brick_(brick), mesh_(mesh), triangle_(triangle), center_(center) {}

  void operator()(int cell, const CellLoop& loop) {
    for (int i = 0; i < loop.size; ++i) {
      const CellEdge edge = cell_edges[loop.edges[i]];
      vertex_[i] = edge_vertex(corner_at(brick_, cell, edge.corner), 1 << edge.axis);
      point_[i] = mesh_.vertices.col(vertex_[i]);
    }
    loop.triangulable ? fill_by_chords(loop) : fill_around_center(loop);
  }

 private:
  void fill_by_chords(const CellLoop& loop) {
    triangulate(loop, point_, triangles_);
    for (int i = 0; i < loop.triangles(); ++i) {
      const auto [a, b, c] = triangles_[i];
      mesh_.triangles.col(triangle_++) << vertex_[a], vertex_[b], vertex_[c];
    }
  }

  void fill_around_center(const CellLoop& loop) {
    Point<3> sum = Point<3>::Zero();
    for (int i = 0; i < loop.size; ++i) {
      sum += point_[i];
      mesh_.triangles.col(triangle_++) << static_cast<int>(center_), vertex_[i], vertex_[(i + 1) % loop.size];
    }
    mesh_.vertices.col(center_++) = sum / loop.size;
  }

  const Brick& brick_;
  Mesh& mesh_;
  Index triangle_;
  Index center_;
  std::array<int, 12> vertex_;
  std::array<Point<3>, 12> point_;
  std::array<LoopTriangle, 12> triangles_;
};

}  // namespace

TriangleOffsets count_triangles(const std::vector<Brick*>& bricks) {
  TriangleOffsets offsets{std::vector<Index>(bricks.size() + 1), std::vector<Index>(bricks.size() + 1)};
  parallel_for(std::ssize(bricks), triangle_bricks, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      for_each_loop(*bricks[i], [&](int, const CellLoop& loop) {
        offsets.triangles[i + 1] += loop.triangles();
        offsets.centers[i + 1] += loop.triangulable ? 0 : 1;
      });
  });
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    offsets.triangles[i + 1] += offsets.triangles[i];
    offsets.centers[i + 1] += offsets.centers[i];
  }
  return offsets;
}

void fill_triangles(const std::vector<Brick*>& bricks, const TriangleOffsets& offsets, Index edge_vertices,
                    Mesh& mesh) {
  parallel_for(std::ssize(bricks), triangle_bricks, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      for_each_loop(*bricks[i],
                    BrickFiller(*bricks[i], mesh, offsets.triangles[i], edge_vertices + offsets.centers[i]));
  });
}

}  // namespace csrbf::polygonization
