#include "csrbf/implicit/mesh/edge_collapse.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/implicit/mesh/triangle_geometry.hpp"

#include <utility>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double steepest_turn = 0.17;  // cosine of 80 degrees: largest angle between a triangle before and after
constexpr double needle = 0.1;          // roundness below which a triangle is a needle

// Twice the area over the square of the longest side: sqrt(3) / 2 for equal sides, 0 for triangles without area.
double roundness(const Point<3>& a, const Point<3>& b, const Point<3>& c) {
  const double longest = std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()});
  return longest > 0 ? area_vector(a, b, c).norm() / longest : 0.0;
}

// Leaves these columns, whose numbers ascend; in place, for there may be millions.
void keep_columns(const std::vector<int>& kept, Points<3>& points) {
  for (std::size_t i = 0; i < kept.size(); ++i) points.col(static_cast<Index>(i)) = points.col(kept[i]);
  points.conservativeResize(3, std::ssize(kept));
}

}  // namespace

EdgeCollapser::EdgeCollapser(Mesh& mesh)
    : mesh_(mesh),
      first_(mesh.vertices.cols(), -1),
      next_(3 * mesh.triangles.cols(), -1),
      gone_(mesh.triangles.cols()) {
  if (std::ssize(next_) > std::numeric_limits<int>::max())
    throw SolverFailure("polygonize: more than 2^31 corners of triangles; lower the resolution");
  for (auto corner = static_cast<int>(next_.size()) - 1; corner >= 0; --corner) {
    int& first = first_[mesh.triangles(corner % 3, corner / 3)];
    next_[corner] = first;
    first = corner;
  }
}

void EdgeCollapser::collect(int v, std::vector<int>& found) const {
  found.clear();
  for (int corner = first_[v]; corner >= 0; corner = next_[corner])
    found.push_back(mesh_.triangles((corner + 1) % 3, corner / 3));  // each neighbour follows v in one triangle
}

const std::vector<int>& EdgeCollapser::neighbours(int v) {
  collect(v, around_);
  return around_;
}

bool EdgeCollapser::keeps_topology(int u, int v) {
  collect(u, around_u_);
  collect(v, around_v_);
  if (around_u_.size() == 3 && around_v_.size() == 3) return false;  // a tetrahedron
  const auto common = std::count_if(around_v_.begin(), around_v_.end(), [&](int w) {
    return std::find(around_u_.begin(), around_u_.end(), w) != around_u_.end();
  });
  return common == 2;
}

bool EdgeCollapser::keeps_shape(int u, int v, const Point<3>& p) const {
  for (const int moved : {u, v}) {
    const int other = moved == u ? v : u;
    for (int corner = first_[moved]; corner >= 0; corner = next_[corner]) {
      const int t = corner / 3;
      const int b = mesh_.triangles((corner + 1) % 3, t), c = mesh_.triangles((corner + 2) % 3, t);
      if (b == other || c == other) continue;
      const Point<3> from = mesh_.vertices.col(moved), pb = mesh_.vertices.col(b), pc = mesh_.vertices.col(c);
      const double before = roundness(from, pb, pc), after = roundness(p, pb, pc);
      if (!(after >= std::min(before, needle))) return false;
      const Point<3> old_area = area_vector(from, pb, pc), new_area = area_vector(p, pb, pc);
      if (before > needle && old_area.dot(new_area) < steepest_turn * old_area.norm() * new_area.norm()) return false;
    }
  }
  return true;
}

void EdgeCollapser::drop_gone(int v) {
  for (int* link = &first_[v]; *link >= 0;) {
    if (gone_[*link / 3])
      *link = next_[*link];
    else
      link = &next_[*link];
  }
}

bool EdgeCollapser::collapse(int u, int v, const Point<3>& p) {
  if (!keeps_topology(u, v) || !keeps_shape(u, v, p)) return false;
  mesh_.vertices.col(u) = p;
  int last = -1;
  for (int corner = first_[v]; corner >= 0; corner = next_[corner]) {
    const int t = corner / 3;
    gone_[t] = (mesh_.triangles.col(t).array() == u).any();
    last = corner;
  }
  for (int corner = first_[v]; corner >= 0; corner = next_[corner]) mesh_.triangles(corner % 3, corner / 3) = u;
  next_[last] = std::exchange(first_[u], std::exchange(first_[v], -1));
  drop_gone(u);
  for (const int w : around_v_)
    if (w != u) drop_gone(w);
  return true;
}

std::vector<int> EdgeCollapser::finish() {
  std::vector<int> old_number, new_number(first_.size(), -1);
  for (std::size_t v = 0; v < first_.size(); ++v) {
    if (first_[v] < 0) continue;
    new_number[v] = static_cast<int>(old_number.size());
    old_number.push_back(static_cast<int>(v));
  }
  Index kept = 0;
  for (Index t = 0; t < mesh_.triangles.cols(); ++t) {
    if (gone_[t]) continue;
    const Eigen::Vector3i triangle = mesh_.triangles.col(t);
    mesh_.triangles.col(kept++) << new_number[triangle[0]], new_number[triangle[1]], new_number[triangle[2]];
  }
  mesh_.triangles.conservativeResize(3, kept);
  keep_columns(old_number, mesh_.vertices);
  if (mesh_.normals.cols() > 0) keep_columns(old_number, mesh_.normals);
  return old_number;
}

std::vector<int> collapse_short_edges(double length, Mesh& mesh, const std::vector<char>& pinned) {
  const auto is_pinned = [&](int v) { return !pinned.empty() && pinned[v] != 0; };
  const auto is_short = [&](int a, int b) {
    return !is_pinned(a) && !is_pinned(b) &&
           (mesh.vertices.col(a) - mesh.vertices.col(b)).squaredNorm() < length * length;
  };
  std::vector<int> ends;  // of short edges; each is seen from both sides
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int c = 0; c < 3; ++c)
      if (is_short(mesh.triangles(c, t), mesh.triangles((c + 1) % 3, t))) ends.push_back(mesh.triangles(c, t));
  if (ends.empty()) return {};
  EdgeCollapser collapser(mesh);
  const auto shorten = [&](int u) {
    const std::vector<int> around = collapser.neighbours(u);
    return std::any_of(around.begin(), around.end(),
                       [&](int v) { return is_short(u, v) && collapser.collapse(u, v, mesh.vertices.col(u)); });
  };
  for (const int u : ends)
    while (shorten(u)) {
    }
  return collapser.finish();
}

}  // namespace csrbf
