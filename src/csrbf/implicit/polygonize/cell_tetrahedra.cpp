#include "csrbf/implicit/polygonize/cell_tetrahedra.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/polygonize/edge_vertices.hpp"

namespace csrbf::polygonization {
namespace {

constexpr Index tetrahedra_bricks = 64;    // large enough to hide the cost of a task
constexpr double diagonal_tie = 1 + 1e-6;  // ratio within which diagonals differ by rounding only: the first wins

// Corners of a cell, each one step along another axis from the one before.
struct Tetrahedron {
  std::array<int, 4> corner;
  bool mirrored;  // left-handed
};

constexpr std::array<Tetrahedron, 6> tetrahedra{{{{0, 1, 3, 7}, false},
                                                 {{0, 2, 6, 7}, false},
                                                 {{0, 4, 5, 7}, false},
                                                 {{0, 1, 5, 7}, true},
                                                 {{0, 2, 3, 7}, true},
                                                 {{0, 4, 6, 7}, true}}};

// An even permutation i j k l of the corners of a tetrahedron with the first `lone` of them on one side.
struct Cut {
  int lone = 0;         // 0: not crossed; 1: the corner i is alone; 2: i, j against k, l
  bool inside = false;  // side of i
  std::array<int, 4> order{};
};

constexpr std::array<std::array<int, 4>, 12> even_permutations{{{0, 1, 2, 3},
                                                                {0, 2, 3, 1},
                                                                {0, 3, 1, 2},
                                                                {1, 0, 3, 2},
                                                                {1, 2, 0, 3},
                                                                {1, 3, 2, 0},
                                                                {2, 0, 1, 3},
                                                                {2, 1, 3, 0},
                                                                {2, 3, 0, 1},
                                                                {3, 0, 2, 1},
                                                                {3, 1, 0, 2},
                                                                {3, 2, 1, 0}}};

constexpr Cut make_cut(unsigned inside) {
  const int count = std::popcount(inside);
  if (count == 0 || count == 4) return {};
  const int lone = count == 2 ? 2 : 1;
  const bool lone_inside = count < 3;
  for (const std::array<int, 4>& order : even_permutations) {
    unsigned first = 0;
    for (int i = 0; i < lone; ++i) first |= 1U << order[i];
    if (first == (lone_inside ? inside : ~inside & 15U)) return {lone, lone_inside, order};
  }
  return {};
}

constexpr std::array<Cut, 16> make_cuts() {
  std::array<Cut, 16> cuts;
  for (unsigned inside = 0; inside < 16; ++inside) cuts[inside] = make_cut(inside);
  return cuts;
}

constexpr std::array<Cut, 16> cuts = make_cuts();

// Calls visit(cell, tetrahedron, cut) for the crossed tetrahedra of a brick.
template <class Visit>
void for_each_cut(const Brick& brick, const Visit& visit) {
  if (brick.active == 0) return;
  const Octet inside = inside_corners(brick);
  for (Mask left = brick.active; left != 0; left &= left - 1) {
    const int cell = std::countr_zero(left);
    for (const Tetrahedron& tetrahedron : tetrahedra) {
      unsigned corners = 0;
      for (int i = 0; i < 4; ++i) corners |= static_cast<unsigned>(inside[tetrahedron.corner[i]] >> cell & 1) << i;
      const Cut& cut = cuts[corners];
      if (cut.lone > 0) visit(cell, tetrahedron, cut);
    }
  }
}

// The vertex on the edge between two corners of a tetrahedron.
int vertex_between(const Brick& brick, int cell, const Tetrahedron& tetrahedron, int i, int j) {
  const int lower = tetrahedron.corner[std::min(i, j)];
  const int upper = tetrahedron.corner[std::max(i, j)];
  return edge_vertex(corner_at(brick, cell, lower), lower ^ upper);
}

void fill_brick(const Brick& brick, Index triangle, Mesh& mesh) {
  const auto squared_length = [&](int a, int b) { return (mesh.vertices.col(a) - mesh.vertices.col(b)).squaredNorm(); };
  for_each_cut(brick, [&](int cell, const Tetrahedron& tetrahedron, const Cut& cut) {
    const auto [i, j, k, l] = cut.order;
    const auto between = [&](int a, int b) { return vertex_between(brick, cell, tetrahedron, a, b); };
    const bool flipped = cut.inside == tetrahedron.mirrored;
    const auto add = [&](int a, int b, int c) {
      mesh.triangles.col(triangle++) << a, (flipped ? c : b), (flipped ? b : c);
    };
    if (cut.lone == 1) {
      add(between(i, j), between(i, k), between(i, l));
      return;
    }
    const int a = between(i, k), b = between(i, l), c = between(j, l), d = between(j, k);
    if (squared_length(a, c) <= squared_length(b, d) * diagonal_tie) {
      add(a, b, c);
      add(a, c, d);
    } else {
      add(a, b, d);
      add(b, c, d);
    }
  });
}

}  // namespace

void march_tetrahedra(const std::vector<Brick*>& bricks, Mesh& mesh) {
  const auto n = std::ssize(bricks);
  std::vector<Index> first(bricks.size() + 1);
  parallel_for(n, tetrahedra_bricks, [&](Index begin, Index end) {
    for (Index b = begin; b < end; ++b)
      for_each_cut(*bricks[b], [&](int, const Tetrahedron&, const Cut& cut) { first[b + 1] += cut.lone; });
  });
  for (std::size_t b = 0; b < bricks.size(); ++b) first[b + 1] += first[b];
  mesh.triangles.resize(3, first.back());
  parallel_for(n, tetrahedra_bricks, [&](Index begin, Index end) {
    for (Index b = begin; b < end; ++b) fill_brick(*bricks[b], first[b], mesh);
  });
}

}  // namespace csrbf::polygonization
