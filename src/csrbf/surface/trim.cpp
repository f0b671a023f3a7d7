#include "csrbf/surface/trim.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/mesh/clip_mesh.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/surface/check/data_support.hpp"

#include <Eigen/Geometry>

#include <map>
#include <numeric>
#include <queue>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index facing_neighbors = 8;  // nearest points of which one must face the same way
constexpr double facing = 0.7;         // least cosine between normals that face the same way: 45 degrees
constexpr double overlap = 0.5;        // spacings by which a trimmed mesh reaches beyond the outermost points
constexpr Index triangles_asked = 5000, points_asked = 100'000;  // for the share without data
constexpr Index many_shards = 10;                                // components; a few are visible in their number

// Samples in Morton order.
struct Samples {
  Samples(const PointsRef<3>& x, const PointsRef<3>& n) : order(morton_order<3>(x)), points(x(Eigen::all, order)) {
    if (n.cols() > 0) normals = n(Eigen::all, order);
  }

  std::vector<Index> order;
  Points<3> points, normals{3, 0};
  KdTree<3> tree{points};
};

// The distance that trim() keeps at each vertex, and how far it is within that from the nearest sample, and from the
// nearest one of some that faces the same way; negative beyond it.
struct Depths {
  Eigen::VectorXd reach, any, facing;
};

Depths depths_of(const Mesh& mesh, const Samples& samples, double distance) {
  const bool has_normals = samples.normals.cols() > 0;
  const Index n = mesh.vertices.cols(), asked = has_normals ? std::min(facing_neighbors, samples.points.cols()) : 1;
  Depths depth{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  parallel_for(n, 1024, [&](Index begin, Index end) {
    std::array<Index, facing_neighbors> index{};
    std::array<double, facing_neighbors> squared{};
    for (Index v = begin; v < end; ++v) {
      const Index found = samples.tree.nearest(mesh.vertices.col(v), asked, index.data(), squared.data());
      const double reach = distance * spacing_at(samples.tree, samples.points, index[0]);
      depth.reach[v] = reach;
      depth.any[v] = reach - std::sqrt(squared[0]);
      depth.facing[v] = -reach;
      for (Index k = 0; k < found && depth.facing[v] < 0; ++k)
        if (!has_normals || samples.normals.col(index[k]).dot(mesh.normals.col(v)) > facing)
          depth.facing[v] = std::max(depth.facing[v], reach - std::sqrt(squared[k]));
    }
  });
  return depth;
}

// Connected vertices near samples that all face another way.
struct Place {
  Box<3> box;
  double reach = 0;         // the largest
  Index size = 0;           // vertices
  bool is_closing = false;  // goes on where there are no samples
};

// Depths by facing samples, but for narrow places in a larger part of the mesh that stays, as on noisy edges: holes of
// the data so narrow stay filled, too. Those that go on where there are no samples are the far side of a sheet.
Eigen::VectorXd depths(const Mesh& mesh, const Samples& samples, double distance) {
  Depths depth_by = depths_of(mesh, samples, distance);
  const Eigen::VectorXd& any = depth_by.any;
  Eigen::VectorXd& depth = depth_by.facing;
  const Index n = depth.size();
  std::vector<char> turned(n, 0);
  for (Index v = 0; v < n; ++v) turned[v] = depth[v] < 0 && any[v] > 0 ? 1 : 0;
  DisjointSets sets(static_cast<std::size_t>(n));
  const auto each_edge = [&](const auto& visit) {
    for (Index t = 0; t < mesh.triangles.cols(); ++t)
      for (int c = 0; c < 3; ++c) visit(mesh.triangles(c, t), mesh.triangles((c + 1) % 3, t));
  };
  each_edge([&](Index a, Index b) {
    if (turned[a] != 0 && turned[b] != 0) sets.unite(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
  });
  std::map<std::uint32_t, Place> places;
  const auto place_of = [&](Index v) -> Place& { return places[sets.find(static_cast<std::uint32_t>(v))]; };
  for (Index v = 0; v < n; ++v) {
    if (turned[v] == 0) continue;
    Place& place = place_of(v);
    place.box.add(mesh.vertices.col(v));
    place.reach = std::max(place.reach, depth_by.reach[v]);
    ++place.size;
  }
  if (places.empty()) return depth;
  each_edge([&](Index a, Index b) {
    if (turned[a] != 0 && any[b] <= 0) place_of(a).is_closing = true;
    if (turned[b] != 0 && any[a] <= 0) place_of(b).is_closing = true;
  });
  Index count = 0;
  const std::vector<Index> component = component_labels(mesh, count);
  std::vector<Index> staying(count, 0);  // vertices
  for (Index v = 0; v < n; ++v) staying[component[v]] += depth[v] > 0 ? 1 : 0;
  for (Index v = 0; v < n; ++v) {
    if (turned[v] == 0) continue;
    const Place& place = place_of(v);
    const bool is_narrow = place.box.diagonal() < 2 * place.reach && 2 * place.size < staying[component[v]];
    if (is_narrow && !place.is_closing) depth[v] = any[v];
  }
  return depth;
}

// Neighbours of each vertex, and which vertices are on the boundary.
struct Neighbors {
  std::vector<Index> begin;
  std::vector<std::int32_t> vertex;
  std::vector<char> on_boundary;
};

// An edge between two triangles occurs once in each direction: sums of its other ends, with signs, vanish.
Neighbors neighbors_of(const Mesh& mesh) {
  Neighbors near{std::vector<Index>(mesh.vertices.cols() + 1, 0), {}, std::vector<char>(mesh.vertices.cols(), 0)};
  for (Index i = 0; i < mesh.triangles.size(); ++i) near.begin[mesh.triangles.data()[i] + 1] += 2;
  std::partial_sum(near.begin.begin(), near.begin.end(), near.begin.begin());
  near.vertex.resize(2 * mesh.triangles.size());
  std::vector<Index> next(near.begin.begin(), near.begin.end() - 1);
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int c = 0; c < 3; ++c)
      for (const int other : {1, 2}) near.vertex[next[mesh.triangles(c, t)]++] = mesh.triangles((c + other) % 3, t);
  for (Index v = 0; v < mesh.vertices.cols(); ++v) {
    const auto first = near.vertex.begin() + near.begin[v], last = near.vertex.begin() + near.begin[v + 1];
    std::sort(first, last);
    for (auto end = first; end != last;) {
      const auto begin = end;
      end = std::upper_bound(begin, last, *begin);
      if (end - begin == 1) near.on_boundary[v] = 1;
    }
  }
  return near;
}

// Distance of the vertices from the boundary along the mesh, less that of the boundary from the samples but for
// `overlap` spacings: negative in the margin that trim() takes off again. Large where it is not near.
Eigen::VectorXd beyond_margin(const Mesh& mesh, const Samples& samples) {
  const Neighbors near = neighbors_of(mesh);
  Eigen::VectorXd result = Eigen::VectorXd::Constant(mesh.vertices.cols(), std::numeric_limits<double>::infinity());
  std::vector<std::int32_t> source(mesh.vertices.cols(), -1);  // the vertex of the boundary that is nearest
  std::vector<double> margin(mesh.vertices.cols(), 0);
  using Entry = std::pair<double, std::int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto reach = [&](std::int32_t v, std::int32_t from) {
    const double value = (mesh.vertices.col(v) - mesh.vertices.col(from)).norm() - margin[from];
    if (!(value < result[v])) return;
    result[v] = value;
    source[v] = from;
    open.emplace(value, v);
  };
  for (std::int32_t v = 0; v < mesh.vertices.cols(); ++v) {
    if (near.on_boundary[v] == 0) continue;
    Index nearest = 0;
    double squared = 0;
    samples.tree.nearest(mesh.vertices.col(v), 1, &nearest, &squared);
    margin[v] = std::sqrt(squared) - overlap * spacing_at(samples.tree, samples.points, nearest);
    if (margin[v] > 0) reach(v, v);
  }
  while (!open.empty()) {
    const auto [value, v] = open.top();
    open.pop();
    if (value > result[v] || value >= 0) continue;
    for (Index k = near.begin[v]; k < near.begin[v + 1]; ++k) reach(near.vertex[k], source[v]);
  }
  return result;
}

// The chosen triangles and their vertices, in the old order.
Mesh submesh(const Mesh& mesh, const std::vector<Index>& triangles) {
  std::vector<char> used(mesh.vertices.cols(), 0);
  for (const Index t : triangles)
    for (int c = 0; c < 3; ++c) used[mesh.triangles(c, t)] = 1;
  std::vector<Index> kept;
  std::vector<std::int32_t> number(used.size(), -1);
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] != 0) {
      number[v] = static_cast<std::int32_t>(kept.size());
      kept.push_back(static_cast<Index>(v));
    }
  Mesh part;
  part.space = mesh.space;
  part.vertices = mesh.vertices(Eigen::all, kept);
  if (mesh.normals.cols() > 0) part.normals = mesh.normals(Eigen::all, kept);
  for (const Property& property : mesh.properties)
    part.properties.push_back({property.name, property.type, property.values(kept)});
  part.triangles.resize(3, static_cast<Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int c = 0; c < 3; ++c) part.triangles(c, static_cast<Index>(t)) = number[mesh.triangles(c, triangles[t])];
  return part;
}

constexpr unsigned pause_after = 1U << 13;  // sides of triangles between two questions whether the work is interrupted

// Triangles around a vertex form fans, joined by common edges; every fan but the first gets its own copy of the vertex.
void double_shared_vertices(Mesh& mesh) {
  const Index corners = 3 * mesh.triangles.cols();
  DisjointSets fans(static_cast<std::size_t>(corners));
  struct Side {
    std::int32_t from, to;
    std::uint32_t start, end;  // corners
  };
  InterruptionPoint pause(pause_after);
  std::vector<Side> sides;
  sides.reserve(corners);
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    for (Index c = 0; c < 3; ++c) {
      const auto start = static_cast<std::uint32_t>(3 * t + c), end = static_cast<std::uint32_t>(3 * t + (c + 1) % 3);
      const std::int32_t a = mesh.triangles(c, t), b = mesh.triangles((c + 1) % 3, t);
      sides.push_back(a < b ? Side{a, b, start, end} : Side{b, a, end, start});
    }
  std::sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) {
    pause();
    return std::tie(a.from, a.to, a.start) < std::tie(b.from, b.to, b.start);
  });
  for (std::size_t i = 1; i < sides.size(); ++i) {
    pause();
    if (sides[i].from != sides[i - 1].from || sides[i].to != sides[i - 1].to) continue;
    fans.unite(sides[i].start, sides[i - 1].start);
    fans.unite(sides[i].end, sides[i - 1].end);
  }

  std::vector<Index> fan_of(mesh.vertices.cols(), -1), copies;
  std::map<Index, std::int32_t> copy_of_fan;
  for (Index corner = 0; corner < corners; ++corner) {
    pause();
    std::int32_t& vertex = mesh.triangles(corner % 3, corner / 3);
    Index& first = fan_of[vertex];
    const Index fan = fans.find(static_cast<std::uint32_t>(corner));
    if (first < 0) first = fan;
    if (first == fan) continue;
    const auto [copy, is_new] =
        copy_of_fan.emplace(fan, static_cast<std::int32_t>(mesh.vertices.cols() + static_cast<Index>(copies.size())));
    if (is_new) copies.push_back(vertex);
    vertex = copy->second;
  }
  if (copies.empty()) return;
  std::vector<Index> columns(mesh.vertices.cols());
  std::iota(columns.begin(), columns.end(), Index{0});
  columns.insert(columns.end(), copies.begin(), copies.end());
  mesh.vertices = Points<3>(mesh.vertices(Eigen::all, columns));
  if (mesh.normals.cols() > 0) mesh.normals = Points<3>(mesh.normals(Eigen::all, columns));
  for (Property& property : mesh.properties) property.values = Eigen::VectorXd(property.values(columns));
}

std::string warning_of_shards(Index shards, Index components) {
  if (shards < many_shards) return {};
  return std::to_string(shards) + " of the " + std::to_string(components) +
         " components of the mesh have fewer than 64 points each and lie beside others: a surface is torn there if it "
         "is too thin or too noisy for its points; normals, more points or less noise may hold it together";
}

}  // namespace

Mesh trim(const Mesh& mesh, const PointsRef<3>& points, double distance, const PointsRef<3>& normals) {
  require(distance > 0, "trim", "distance", distance, "must be a positive number of local spacings");
  require(points.cols() >= 2, "trim", "points", points.cols(), "at least 2 are needed");
  require(normals.cols() == 0 || normals.cols() == points.cols(), "trim", "normals", normals.cols(),
          "must be one per point, or none");
  const Samples samples(points, normals);
  const Mesh near = clip_mesh(mesh, depths(mesh, samples, distance));
  Mesh trimmed = clip_mesh(near, beyond_margin(near, samples));
  double_shared_vertices(trimmed);
  return trimmed;
}

double share_without_data(const Mesh& mesh, const PointsRef<3>& points, double distance) {
  // Scanners write points in rows: every k-th of them may be a column.
  const std::uint64_t golden = 0x9E3779B97F4A7C15U,
                      every = 1 + static_cast<std::uint64_t>(points.cols() / points_asked);
  std::vector<Index> chosen;
  for (Index i = 0; i < points.cols(); ++i)
    if (static_cast<std::uint64_t>(i) * golden <= ~std::uint64_t{0} / every) chosen.push_back(i);
  const Points<3> some = points(Eigen::all, chosen);
  const KdTree<3> tree(some);
  double all = 0, without = 0;
  for (Index t = 0; t < mesh.triangles.cols(); t += 1 + mesh.triangles.cols() / triangles_asked) {
    const Point<3> a = mesh.vertices.col(mesh.triangles(0, t)), b = mesh.vertices.col(mesh.triangles(1, t)),
                   c = mesh.vertices.col(mesh.triangles(2, t));
    const double area = (b - a).cross(c - a).norm();
    Index nearest = 0;
    double squared = 0;
    tree.nearest((a + b + c) / 3, 1, &nearest, &squared);
    all += area;
    if (std::sqrt(squared) > distance * spacing_at(tree, some, nearest)) without += area;
  }
  return all > 0 ? without / all : 0;
}

DataComponents keep_components_with_data(Mesh mesh, const PointsRef<3>& points) {
  Index count = 0;
  const std::vector<Index> label = component_labels(mesh, count);
  if (count <= 1 || points.cols() == 0) return {std::move(mesh), 0};
  const std::vector<DataSupport> supports = data_support(mesh, label, count, points);
  const std::vector<char> keep = components_with_data(supports);
  const Index dropped = std::count(keep.begin(), keep.end(), 0);
  std::string warning = warning_of_shards(count_shards(supports, keep), count - dropped);
  if (dropped == 0) return {std::move(mesh), 0, std::move(warning)};
  std::vector<Index> triangles;
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    if (keep[label[mesh.triangles(0, t)]] != 0) triangles.push_back(t);
  return {submesh(mesh, triangles), dropped, std::move(warning)};
}

}  // namespace csrbf
