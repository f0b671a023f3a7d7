#include "csrbf/surface/normals/orient_normals.hpp"

#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/surface/normals/contradictions.hpp"
#include "csrbf/surface/normals/orientation_energy.hpp"

namespace csrbf {
namespace {

using namespace orientation;

// Chosen by hand. The matrix of winding numbers has a column per cluster: time and memory grow with their number.
constexpr Index max_components = 256;
constexpr Index max_clusters = 400;
constexpr double convincing = 0.97;       // energy ratio below which the winding number overrules the neighbours: noise
                                          // always allows a small decrease
constexpr double encloses_nothing = 0.3;  // energy above which it does not: hills and houses are no solids, though
                                          // their energy is lower one by one
constexpr double encloses_a_solid = 0.1;  // ... below which it does even if that cuts sheets, as where bodies touch
constexpr double encloses_alone = 0.3;    // mean winding number of a body, 0.5 if it is closed
constexpr double clearly_more_even = 0.7;  // largest ratio of unevenness; where ground met statues turned it was .2

void check(const PointsRef<3>& points, const PointsRef<3>& normals, const char* where) {
  require(normals.cols() == points.cols(), where, "normals.cols()", normals.cols(), "must be the number of points");
  require(points.allFinite(), where, "points", "NaN or infinity", "must be finite; remove such points");
  require(normals.allFinite(), where, "normals", "NaN or infinity", "must be finite; set unknown normals to zero");
  require(std::int64_t{points.cols()} < (std::int64_t{1} << 31), where, "points.cols()", points.cols(),
          "must be below 2^31");
}

// A cloud in unit coordinates and Morton order with unit (or zero) normals.
struct Sorted {
  std::vector<Index> order;
  Points<3> points, normals;
};

Sorted sort(const PointsRef<3>& points, const PointsRef<3>& normals) {
  Sorted sorted{morton_order<3>(points), Points<3>(3, points.cols()), Points<3>(3, points.cols())};
  const Box<3> box = bounding_box<3>(points);
  const Point<3> center = 0.5 * box.lo + 0.5 * box.hi;
  const double size = (0.5 * box.hi - 0.5 * box.lo).maxCoeff(), scale = size > 0 ? size : 1;
  for (Index k = 0; k < points.cols(); ++k) {
    const Index i = sorted.order[k];
    sorted.points.col(k) = (points.col(i) - center) / scale;
    const double length = normals.col(i).stableNorm();
    sorted.normals.col(k) = length > 0 ? Point<3>(normals.col(i) / length) : Point<3>::Zero();
  }
  return sorted;
}

// Signs of the clusters that leave most normals unchanged.
Signs majority(const Clusters& clusters) {
  std::vector<Index> sum(clusters.size(), 0);
  for (std::size_t i = 0; i < clusters.of.size(); ++i)
    if (clusters.of[i] >= 0) sum[clusters.of[i]] += clusters.sign[i];
  Signs signs;
  for (const Index s : sum) signs.push_back(s < 0 ? -1 : 1);
  return signs;
}

void apply(const Clusters& clusters, const Signs& signs, Points<3>& normals) {
  for (Index i = 0; i < normals.cols(); ++i)
    if (clusters.of[i] >= 0) normals.col(i) *= clusters.sign[i] * signs[clusters.of[i]];
}

// Whether more of the surface faces +z (else +y, +x) than away from it: 1 or -1.
int upward(const Points<3>& normals, const NeighborTable& table, const Clusters& clusters, const Signs& signs) {
  Point<3> sum = Point<3>::Zero();
  double total = 0;
  for (Index i = 0; i < normals.cols(); ++i) {
    if (clusters.of[i] < 0) continue;
    sum += table.area(i) * clusters.sign[i] * signs[clusters.of[i]] * normals.col(i);
    total += table.area(i);
  }
  for (const Index axis : {2, 1, 0})  // unless less than a tenth of the area decides; chosen by hand
    if (std::abs(sum[axis]) > 0.1 * total) return sum[axis] < 0 ? -1 : 1;
  return 1;
}

// Flips all signs if that is the better side.
void settle_side(const Energy& energy, const Points<3>& normals, const NeighborTable& table, const Clusters& clusters,
                 Signs& signs) {
  Signs opposite = signs;
  for (signed char& sign : opposite) sign = static_cast<signed char>(-sign);
  const bool turn = std::abs(energy.mean_winding(signs)) > has_inside ? energy.of(opposite) < energy.of(signs)
                                                                      : upward(normals, table, clusters, signs) < 0;
  if (turn) signs = opposite;
}

// Turns components that enclose a solid by themselves outward, such as a ball above the ground, and the rest upward if
// there are any: the winding number of both together does not tell the side of either.
void turn_bodies_outward(const Points<3>& points, const NeighborTable& neighbors, const Graph& graph,
                         Points<3>& normals) {
  const Clusters components = make_clusters(graph, normals, graph.near, max_components);
  if (components.size() < 2) return;
  const Energy energy(points, normals, neighbors, graph, components);
  Signs outward(components.size(), 1), other(components.size(), -1);  // the same for bodies
  energy.turn_each_outward(outward, encloses_alone);
  energy.turn_each_outward(other, encloses_alone);
  if (std::equal(outward.begin(), outward.end(), other.begin(), std::not_equal_to<>())) return;
  const Signs signs = majority(components);
  Clusters rest = components;
  for (std::int32_t& c : rest.of)
    if (c >= 0 && outward[c] == other[c]) c = -1;
  const int side = upward(normals, neighbors, rest, signs);
  for (Index i = 0; i < normals.cols(); ++i)
    if (const std::int32_t c = components.of[i]; c >= 0)
      normals.col(i) *= outward[c] == other[c] ? signs[c] * outward[c] : side;
}

// Turns clusters by the winding number if that lowers the energy enough.
void turn_clusters(const Points<3>& points, const NeighborTable& neighbors, const Graph& graph, bool one_component,
                   Points<3>& normals, OrientReport& result) {
  const Clusters clusters = make_clusters(graph, normals, graph.certain, max_clusters);
  const Energy energy(points, normals, neighbors, graph, clusters);
  Signs signs = majority(clusters);
  settle_side(energy, normals, neighbors, clusters, signs);
  result.ambiguity = energy.of(signs);
  if (one_component) result.ambiguity_tree = result.ambiguity;
  Signs better = signs;
  energy.descend(better);
  settle_side(energy, normals, neighbors, clusters, better);
  const auto with = [&](const Signs& chosen) {
    Points<3> turned = normals;
    apply(clusters, chosen, turned);
    return turned;
  };
  Points<3> by_neighbors = with(signs);
  const auto take = [&](const Signs& chosen) {
    Points<3> turned = with(chosen);
    if (!(energy.of(chosen) < encloses_a_solid) && cuts_sheet(points, neighbors, turned, by_neighbors)) return false;
    by_neighbors = std::move(turned);
    result.ambiguity = energy.of(chosen);
    result.method = OrientMethod::winding_number;
    return true;
  };
  const double lower = energy.of(better);
  if (lower < encloses_nothing) {
    if (lower < convincing * result.ambiguity) take(better);
  } else {
    Signs even = signs;
    energy.even_out(even);
    settle_side(energy, normals, neighbors, clusters, even);
    if (!(energy.unevenness(even) < clearly_more_even * energy.unevenness(signs) && take(even))) even = signs;
    if (energy.turn_bodies_outward(even, encloses_alone)) take(even);
    turn_bodies_outward(points, neighbors, graph, by_neighbors);
  }
  normals = std::move(by_neighbors);
}

}  // namespace

OrientReport orient_normals(const Points<3>& points, const NeighborTable& neighbors, Points<3>& normals,
                            const Progress& progress, bool signs_given) {
  constexpr std::string_view stage = "orient normals";
  OrientReport result;
  if (points.cols() < 2) return result;
  const Points<3> before = normals;
  report(progress, stage, 0);
  const Graph graph = make_graph(points, normals, neighbors, signs_given);
  report(progress, stage, 0.3);

  // Components by the tree, then by the winding number where there are several.
  const Clusters components = make_clusters(graph, normals, graph.near, max_components);
  if (components.size() == 0) return result;
  result.flipped_edges =
      static_cast<double>(components.flipped_edges) / static_cast<double>(std::max<Index>(1, components.tree_edges));
  Signs signs = components.tree_sign;
  if (components.size() > 1) {
    const Energy energy(points, normals, neighbors, graph, components);
    settle_side(energy, normals, neighbors, components, signs);
    const double tree = energy.of(signs);
    Signs outward = signs;
    energy.turn_each_outward(outward);
    energy.descend(signs);
    energy.descend(outward);
    if (energy.of(outward) < energy.of(signs)) signs = outward;
    result.ambiguity_tree = tree;
    if (signs != components.tree_sign) result.method = OrientMethod::winding_number;
  }
  apply(components, signs, normals);
  report(progress, stage, 0.6);

  turn_clusters(points, neighbors, graph, components.size() == 1, normals, result);
  Index turned = 0;
  for (Index i = 0; i < normals.cols(); ++i) turned += normals.col(i).dot(before.col(i)) < 0 ? 1 : 0;
  result.turned = static_cast<double>(turned) / static_cast<double>(normals.cols());
  report(progress, stage, 1);
  return result;
}

OrientReport orient_normals(const PointsRef<3>& points, Points<3>& normals, const OrientOptions& options) {
  check(points, normals, "orient_normals");
  require(options.neighbors >= 3, "orient_normals", "neighbors", options.neighbors, "must be at least 3; 12 is usual");
  if (points.cols() == 0) return {};
  Sorted sorted = sort(points, normals);
  const Points<3> before = sorted.normals;
  const NeighborTable table = make_neighbor_table(sorted.points, KdTree<3>(sorted.points), options.neighbors);
  const OrientReport result =
      orient_normals(sorted.points, table, sorted.normals, options.progress, options.signs_given);
  for (Index k = 0; k < before.cols(); ++k)
    if (sorted.normals.col(k).dot(before.col(k)) < 0)
      normals.col(sorted.order[k]) = -normals.col(sorted.order[k]).eval();
  return result;
}

double orientation_consistency(const PointsRef<3>& points, const PointsRef<3>& normals) {
  check(points, normals, "orientation_consistency");
  if (points.cols() < 2) return 1;
  const Sorted sorted = sort(points, normals);
  const NeighborTable table = make_neighbor_table(sorted.points, KdTree<3>(sorted.points), OrientOptions{}.neighbors);
  const Graph graph = make_graph(sorted.points, sorted.normals, table);
  // Under noise hardly any pair may be certain: then all count.
  const std::size_t pairs = 10 * graph.certain >= graph.near ? graph.certain : graph.near;
  Index agreeing = 0;
  for (std::size_t e = 0; e < pairs; ++e)
    agreeing += sorted.normals.col(graph.edges[e].a).dot(sorted.normals.col(graph.edges[e].b)) > 0 ? 1 : 0;
  return pairs == 0 ? 1 : static_cast<double>(agreeing) / static_cast<double>(pairs);
}

}  // namespace csrbf
