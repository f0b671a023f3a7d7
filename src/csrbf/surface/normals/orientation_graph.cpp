#include "csrbf/surface/normals/orientation_graph.hpp"

#include "csrbf/core/interruption.hpp"
#include "csrbf/core/parallel.hpp"

#include <numeric>

namespace csrbf::orientation {
namespace {

constexpr unsigned pause_after = 1U << 14;  // edges between two questions whether the work is interrupted

constexpr double certain_cost = 0.4;  // below, an edge is reliable; larger: fewer clusters, wrong signs inside. By hand
constexpr double max_cost = 4;        // largest total: 2 for the edge, 1 for the roughness at each end
constexpr int buckets = 4096;         // of costs in [0, max_cost], for a counting sort: a resolution of 0.001
constexpr Index thinning = 8;         // factor between the subsets that bridge gaps: few rounds, chosen by hand

// Mean sine of the angle between a tangent plane and the directions to the neighbours: increased by curvature, noise,
// edges and other sheets.
Eigen::VectorXd roughness(const Points<3>& points, const Points<3>& normals, const NeighborTable& table,
                          const std::vector<std::uint32_t>& ids) {
  Eigen::VectorXd rough(table.size());
  parallel_for(table.size(), 4096, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Index a = ids[i];
      double sum = 0;
      for (const std::uint32_t other : table.of(i)) {
        const Point<3> step = points.col(ids[other]) - points.col(a);
        const double length = step.norm();
        sum += length > 0 ? std::abs(normals.col(a).dot(step)) / length : 1.0;
      }
      rough[i] = sum / static_cast<double>(std::max<Index>(1, table.k));
    }
  });
  return rough;
}

// Edges of a neighbour table by increasing cost; `ids` are the points of the table.
std::vector<Edge> sort_edges(const Points<3>& points, const Points<3>& normals, const NeighborTable& table,
                             const std::vector<std::uint32_t>& ids, bool signs_given, std::size_t& certain) {
  const Index k = table.k;
  const Eigen::VectorXd rough = roughness(points, normals, table, ids);
  std::vector<std::uint16_t> bucket(table.index.size());
  parallel_for(table.size(), 4096, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Index a = ids[i];
      for (Index j = 0; j < k; ++j) {
        const std::uint32_t other = table.of(i)[j];
        const Index b = ids[other];
        // Mutual neighbours share one edge.
        const auto back = table.of(other);
        const bool repeated =
            other < i && std::find(back.begin(), back.end(), static_cast<std::uint32_t>(i)) != back.end();
        double total = cost(points.col(a), normals.col(a), points.col(b), normals.col(b)) + rough[i] + rough[other];
        if (signs_given && normals.col(a).dot(normals.col(b)) < 0) total = std::min(total + certain_cost, max_cost);
        bucket[i * k + j] = static_cast<std::uint16_t>(
            repeated || !(total <= max_cost) ? buckets
                                             : std::min(buckets - 1, static_cast<int>(total / max_cost * buckets)));
      }
    }
  });
  std::vector<std::size_t> begin(buckets + 2, 0);
  for (const std::uint16_t b : bucket) ++begin[b + std::size_t{1}];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  certain = begin[static_cast<std::size_t>(certain_cost / max_cost * buckets)];
  std::vector<Edge> edges(begin[buckets]);
  InterruptionPoint pause(pause_after);
  for (Index e = 0; e < std::ssize(bucket); ++e) {
    pause();
    if (bucket[e] < buckets) edges[begin[bucket[e]]++] = {ids[e / k], ids[table.index[e]]};
  }
  return edges;
}

int agreement(const Points<3>& normals, const Edge& edge) {
  return normals.col(edge.a).dot(normals.col(edge.b)) < 0 ? -1 : 1;
}

// Every `thinning`-th point of each component, at least one.
std::vector<std::uint32_t> thin_out(const std::vector<std::uint32_t>& ids, Index n, SignedSets& sets) {
  std::vector<std::uint32_t> kept;
  std::vector<std::uint8_t> seen(n, 0);
  for (const std::uint32_t id : ids) {
    std::uint8_t& count = seen[sets.find(id).root];
    if (count == 0) kept.push_back(id);
    count = static_cast<std::uint8_t>((count + 1) % thinning);
  }
  return kept;
}

bool connected(const std::vector<std::uint32_t>& ids, SignedSets& sets) {
  return ids.empty() || std::all_of(ids.begin(), ids.end(), [&, root = sets.find(ids.front()).root](std::uint32_t id) {
           return sets.find(id).root == root;
         });
}

// The edges of a spanning tree: those inside clusters and those between them.
struct Cut {
  std::vector<Edge> inside, between;
};

// Kruskal's algorithm; edges that are not trusted are deferred if both sides have `enough` points.
Cut cut_tree(const Graph& graph, const Points<3>& normals, std::size_t trusted, Index enough) {
  Cut cut;
  SignedSets sets(normals.cols());
  std::vector<Edge> waiting;
  InterruptionPoint pause(pause_after);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    pause();
    const Edge& edge = graph.edges[e];
    const std::uint32_t a = sets.find(edge.a).root, b = sets.find(edge.b).root;
    if (a == b) continue;
    if (e >= trusted && sets.size(a) >= enough && sets.size(b) >= enough) {
      waiting.push_back(edge);
    } else if (sets.join(edge.a, edge.b, agreement(normals, edge))) {
      cut.inside.push_back(edge);
    }
  }
  for (const Edge& edge : waiting) {
    pause();
    if (sets.join(edge.a, edge.b, agreement(normals, edge))) cut.between.push_back(edge);
  }
  return cut;
}

// Numbers the clusters from the root of their tree downwards.
void number_from_root(const std::vector<Edge>& between, Clusters& clusters) {
  const auto count = static_cast<std::size_t>(clusters.size());
  std::vector<std::vector<std::int32_t>> linked(count);
  for (const Edge& edge : between) {
    const std::int32_t a = clusters.of[edge.a], b = clusters.of[edge.b];
    linked[a].push_back(b);
    linked[b].push_back(a);
  }
  std::vector<std::int32_t> number(count, -1), queue;
  clusters.parent.assign(count, -1);
  for (std::size_t root = 0; root < count; ++root) {
    if (number[root] >= 0) continue;
    std::size_t next = queue.size();
    number[root] = static_cast<std::int32_t>(queue.size());
    queue.push_back(static_cast<std::int32_t>(root));
    for (; next < queue.size(); ++next)
      for (const std::int32_t other : linked[queue[next]]) {
        std::int32_t& id = number[other];
        if (id >= 0) continue;
        id = static_cast<std::int32_t>(queue.size());
        clusters.parent[queue.size()] = static_cast<std::int32_t>(next);
        queue.push_back(other);
      }
  }
  const std::vector<signed char> sign = clusters.tree_sign;
  for (std::size_t i = 0; i < count; ++i) clusters.tree_sign[i] = sign[queue[i]];
  for (std::int32_t& id : clusters.of)
    if (id >= 0) id = number[id];
}

}  // namespace

SignedSets::SignedSets(Index n)
    : parent_(static_cast<std::size_t>(n)), sign_(parent_.size(), 1), size_(parent_.size(), 1) {
  std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
}

SignedSets::Found SignedSets::find(Index i) {
  auto node = static_cast<std::uint32_t>(i);
  int sign = 1;
  while (parent_[node] != node) {
    // Path halving.
    const std::uint32_t parent = parent_[node];
    sign_[node] = static_cast<signed char>(sign_[node] * sign_[parent]);
    parent_[node] = parent_[parent];
    sign *= sign_[node];
    node = parent_[node];
  }
  return {node, sign};
}

bool SignedSets::join(Index a, Index b, int sign) {
  Found x = find(a), y = find(b);
  if (x.root == y.root) return false;
  if (size_[x.root] < size_[y.root] || (size_[x.root] == size_[y.root] && x.root > y.root)) std::swap(x, y);
  parent_[y.root] = x.root;
  sign_[y.root] = static_cast<signed char>(sign * x.sign * y.sign);
  size_[x.root] += size_[y.root];
  return true;
}

double cost(const Point<3>& pa, const Point<3>& na, const Point<3>& pb, const Point<3>& nb) {
  const Point<3> edge = pb - pa;
  const double length = edge.norm();
  const double tilt = length > 0 ? 0.5 * (std::abs(na.dot(edge)) + std::abs(nb.dot(edge))) / length : 1.0;
  if (!(na.squaredNorm() > 0) || !(nb.squaredNorm() > 0)) return std::numeric_limits<double>::infinity();
  return std::max(0.0, 1 - std::abs(na.dot(nb))) + tilt;
}

Graph make_graph(const Points<3>& points, const Points<3>& normals, const NeighborTable& table, bool signs_given) {
  Graph graph;
  std::vector<std::uint32_t> ids(points.cols());
  std::iota(ids.begin(), ids.end(), std::uint32_t{0});
  graph.edges = sort_edges(points, normals, table, ids, signs_given, graph.certain);
  graph.near = graph.edges.size();
  SignedSets sets(points.cols());
  InterruptionPoint pause(pause_after);
  for (const Edge& edge : graph.edges) {
    pause();
    sets.join(edge.a, edge.b, 1);
  }
  std::erase_if(ids, [&](std::uint32_t id) { return !(normals.col(id).squaredNorm() > 0); });
  while (!connected(ids, sets)) {
    ids = thin_out(ids, points.cols(), sets);
    const Points<3> subset = points(Eigen::all, ids);
    const NeighborTable sparse = make_neighbor_table(subset, KdTree<3>(subset), table.k);
    std::size_t unused = 0;
    for (const Edge& edge : sort_edges(points, normals, sparse, ids, signs_given, unused))
      if (sets.join(edge.a, edge.b, 1)) graph.edges.push_back(edge);
  }
  return graph;
}

Clusters make_clusters(const Graph& graph, const Points<3>& normals, std::size_t trusted, Index max_clusters) {
  const Index n = normals.cols();
  Index enough = std::max<Index>(16, n / (8 * max_clusters));
  Cut cut = cut_tree(graph, normals, trusted, enough);
  while (static_cast<Index>(cut.between.size()) >= max_clusters) cut = cut_tree(graph, normals, trusted, enough *= 2);

  Clusters clusters;
  SignedSets sets(n), tree(n);
  for (const Edge& edge : cut.inside) sets.join(edge.a, edge.b, agreement(normals, edge));
  for (const auto* edges : {&cut.inside, &cut.between})
    for (const Edge& edge : *edges) {
      tree.join(edge.a, edge.b, agreement(normals, edge));
      ++clusters.tree_edges;
      clusters.flipped_edges += agreement(normals, edge) < 0 ? 1 : 0;
    }
  clusters.of.assign(n, -1);
  clusters.sign.assign(n, 1);
  std::vector<std::int32_t> number(n, -1);
  for (Index i = 0; i < n; ++i) {
    if (!(normals.col(i).squaredNorm() > 0)) continue;
    const auto found = sets.find(i);
    std::int32_t& id = number[found.root];
    if (id < 0) {
      id = static_cast<std::int32_t>(clusters.tree_sign.size());
      clusters.tree_sign.push_back(static_cast<signed char>(tree.find(found.root).sign));
    }
    clusters.of[i] = id;
    clusters.sign[i] = static_cast<signed char>(found.sign);
  }
  number_from_root(cut.between, clusters);
  return clusters;
}

}  // namespace csrbf::orientation
