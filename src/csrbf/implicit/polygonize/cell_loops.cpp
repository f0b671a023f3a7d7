#include "csrbf/implicit/polygonize/cell_loops.hpp"

#include <utility>
#include <vector>

namespace csrbf::polygonization {
namespace {

using Face = std::array<int, 4>;  // corners counter-clockwise seen from outside the cell

// Face 2 axis + side.
constexpr std::array<Face, 6> faces{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

constexpr int edge_between(int a, int b) {
  for (int e = 0; e < 12; ++e) {
    const int lower = cell_edges[e].corner;
    const int upper = lower | 1 << cell_edges[e].axis;
    if ((a == lower && b == upper) || (b == lower && a == upper)) return e;
  }
  return -1;
}

constexpr bool on_face(int edge, int face) {
  const int axis = face / 2;
  return cell_edges[edge].axis != axis && (cell_edges[edge].corner >> axis & 1) == (face & 1);
}

constexpr bool share_face(int e, int f) {
  for (int face = 0; face < 6; ++face)
    if (on_face(e, face) && on_face(f, face)) return true;
  return false;
}

constexpr bool is_inside(unsigned inside, int corner) {
  return inside >> corner & 1;
}

constexpr bool alternates(unsigned inside, const Face& face) {
  return is_inside(inside, face[0]) == is_inside(inside, face[2]) &&
         is_inside(inside, face[1]) == is_inside(inside, face[3]) &&
         is_inside(inside, face[0]) != is_inside(inside, face[1]);
}

constexpr std::array<std::uint8_t, 256> ambiguous_faces_of_all() {
  std::array<std::uint8_t, 256> ambiguous{};
  for (unsigned inside = 0; inside < 256; ++inside)
    for (int f = 0; f < 6; ++f) ambiguous[inside] |= static_cast<std::uint8_t>(alternates(inside, faces[f]) << f);
  return ambiguous;
}

constexpr std::array<std::uint8_t, 256> ambiguous_table = ambiguous_faces_of_all();

// Successor of every crossed edge along the loops. Seen from outside the cell, the segment on a face leads from an edge
// where a walk around the face enters the solid to one where it leaves it, with the solid on the right.
std::array<int, 12> successors(unsigned inside, unsigned joined) {
  std::array<int, 12> next;
  next.fill(-1);
  for (int f = 0; f < 6; ++f) {
    const Face& face = faces[f];
    for (int i = 0; i < 4; ++i) {
      if (is_inside(inside, face[i]) || !is_inside(inside, face[(i + 1) % 4])) continue;
      // If the two inside corners are joined: around the preceding outside corner; otherwise to the next exit edge.
      int leave = (i + 1) % 4;
      if (alternates(inside, face) && (joined >> f & 1)) leave = (i + 3) % 4;
      while (!is_inside(inside, face[leave]) || is_inside(inside, face[(leave + 1) % 4])) leave = (leave + 1) % 4;
      next[edge_between(face[i], face[(i + 1) % 4])] = edge_between(face[leave], face[(leave + 1) % 4]);
    }
  }
  return next;
}

constexpr double tie = 1 + 1e-6;  // ratio of chords that differ by rounding only, as in symmetric loops: the first wins

constexpr double forbidden = std::numeric_limits<double>::infinity();

// Least cost of triangulating the corners i ... j of a polygon, chord(i, j) included, and the apex over i j.
struct Triangulation {
  std::array<std::array<double, 12>, 12> cost;
  std::array<std::array<std::uint8_t, 12>, 12> apex;
};

template <class ChordCost>
void solve(int n, const ChordCost& chord, Triangulation& best) {
  for (int i = 0; i + 1 < n; ++i) best.cost[i][i + 1] = 0;
  for (int span = 2; span < n; ++span) {
    for (int i = 0; i + span < n; ++i) {
      const int j = i + span;
      double least = forbidden;
      best.apex[i][j] = static_cast<std::uint8_t>(i + 1);
      for (int k = i + 1; k < j; ++k) {
        const double cost = best.cost[i][k] + best.cost[k][j];
        if (!(cost * tie < least)) continue;
        least = cost;
        best.apex[i][j] = static_cast<std::uint8_t>(k);
      }
      best.cost[i][j] = span == n - 1 ? least : least + chord(i, j);
    }
  }
}

CellLoop make_loop(const std::vector<int>& edges) {
  CellLoop loop;
  loop.size = static_cast<int>(edges.size());
  for (int i = 0; i < loop.size; ++i) {
    loop.edges[i] = static_cast<std::uint8_t>(edges[i]);
    for (int j = 0; j < loop.size; ++j)
      if (!share_face(edges[i], edges[j])) loop.chords[i] |= static_cast<std::uint16_t>(1 << j);
  }
  Triangulation best;
  solve(
      loop.size, [&](int i, int j) { return loop.chords[i] >> j & 1 ? 1.0 : forbidden; }, best);
  loop.triangulable = best.cost[0][loop.size - 1] < forbidden;
  return loop;
}

// The loops of every sign pattern with every decision on its ambiguous faces.
struct LoopTable {
  struct Range {
    std::uint16_t first = 0;
    std::uint16_t count = 0;
  };
  std::vector<CellLoop> loops;
  std::vector<Range> ranges = std::vector<Range>(256 * 64);

  LoopTable() {
    for (unsigned inside = 0; inside < 256; ++inside) {
      const unsigned ambiguous = ambiguous_faces(inside);
      for (unsigned joined = 0; joined < 64; ++joined)
        if ((joined & ~ambiguous) == 0) add(inside, joined);
    }
  }

  void add(unsigned inside, unsigned joined) {
    std::array<int, 12> next = successors(inside, joined);
    Range& range = ranges[inside * 64 + joined];
    range.first = static_cast<std::uint16_t>(loops.size());
    for (int start = 0; start < 12; ++start) {
      std::vector<int> edges;
      for (int e = start; next[e] >= 0; e = std::exchange(next[e], -1)) edges.push_back(e);
      if (!edges.empty()) loops.push_back(make_loop(edges));
    }
    range.count = static_cast<std::uint16_t>(loops.size() - range.first);
  }
};

}  // namespace

unsigned ambiguous_faces(unsigned inside) {
  return ambiguous_table[inside];
}

unsigned joined_faces(unsigned inside, const std::array<double, 8>& value) {
  unsigned joined = 0;
  for (int f = 0; f < 6; ++f) {
    const Face& face = faces[f];
    if (!alternates(inside, face)) continue;
    const int in = is_inside(inside, face[0]) ? 0 : 1;
    const double inside_product = value[face[in]] * value[face[in + 2]];
    const double outside_product = value[face[1 - in]] * value[face[3 - in]];
    joined |= static_cast<unsigned>(inside_product >= outside_product) << f;
  }
  return joined;
}

std::span<const CellLoop> cell_loops(unsigned inside, unsigned joined) {
  static const LoopTable table;
  const LoopTable::Range range = table.ranges[inside * 64 + joined];
  return {table.loops.data() + range.first, range.count};
}

std::span<const CellLoop> loops_of_cell(const Brick& brick, const Octet& inside_masks, int cell) {
  unsigned inside = 0;
  for (int c = 0; c < 8; ++c) inside |= static_cast<unsigned>(inside_masks[c] >> cell & 1) << c;
  if (ambiguous_faces(inside) == 0) return cell_loops(inside, 0);
  std::array<double, 8> value;
  for (int c = 0; c < 8; ++c) value[c] = corner_at(brick, cell, c).value();
  return cell_loops(inside, joined_faces(inside, value));
}

void triangulate(const CellLoop& loop, const std::array<Point<3>, 12>& points,
                 std::array<LoopTriangle, 12>& triangles) {
  const auto chord = [&](int i, int j) {
    return loop.chords[i] >> j & 1 ? (points[i] - points[j]).squaredNorm() : forbidden;
  };
  const int n = loop.size;
  if (n == 3) {
    triangles[0] = {0, 1, 2};
    return;
  }
  if (n == 4) {
    const bool first = chord(0, 2) <= chord(1, 3) * tie;
    triangles[0] = first ? LoopTriangle{0, 1, 2} : LoopTriangle{0, 1, 3};
    triangles[1] = first ? LoopTriangle{0, 2, 3} : LoopTriangle{1, 2, 3};
    return;
  }
  Triangulation best;
  solve(n, chord, best);
  std::array<std::array<std::uint8_t, 2>, 12> stack;
  int depth = 0;
  int count = 0;
  stack[depth++] = {0, static_cast<std::uint8_t>(n - 1)};
  while (depth > 0) {
    const auto [i, j] = stack[--depth];
    if (j - i < 2) continue;
    const std::uint8_t k = best.apex[i][j];
    triangles[count++] = {i, k, j};
    stack[depth++] = {i, k};
    stack[depth++] = {k, j};
  }
}

}  // namespace csrbf::polygonization
