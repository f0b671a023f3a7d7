#include "csrbf/surface/check/data_support.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <Eigen/Geometry>

#include <numeric>

namespace csrbf {
namespace {

constexpr Index spacing_neighbors = 6;  // as many as surround a sample of a hexagonal packing of the plane
// Chosen by hand.
constexpr double expected_share = 0.05;  // a component with less of the mean density of samples is empty ...
constexpr double fewest_samples = 8;     // ... or with fewer of them
constexpr double near_component = 4;     // spacings: points farther from a component do not count for it
constexpr double small = 64;             // samples: smaller components may be bubbles between sheets, ...
constexpr double crowded = 4;            // ... whose samples represent this many times as much area as they have
constexpr double beside = 1.25;          // spacings: where one surface is torn, some samples on both sides are as near
constexpr Index spacings_asked = 1000;   // samples for the mean of all

std::vector<double> areas(const Mesh& mesh, const std::vector<Index>& label, Index count) {
  std::vector<double> area(count, 0);
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Point<3> a = mesh.vertices.col(mesh.triangles(0, t)), b = mesh.vertices.col(mesh.triangles(1, t)),
                   c = mesh.vertices.col(mesh.triangles(2, t));
    area[label[mesh.triangles(0, t)]] += 0.5 * (b - a).cross(c - a).norm();
  }
  return area;
}

// Indices of the columns of x within `distance` of a point of the tree.
std::vector<Index> ids_within(const KdTree<3>& tree, const PointsRef<3>& x, double distance) {
  std::vector<char> is_near(x.cols());
  parallel_for(x.cols(), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) is_near[i] = tree.any_within(x.col(i), distance) ? 1 : 0;
  });
  std::vector<Index> ids;
  for (std::size_t i = 0; i < is_near.size(); ++i)
    if (is_near[i] != 0) ids.push_back(static_cast<Index>(i));
  return ids;
}

// Mean of the squared spacings of the points, from some of them.
double mean_squared_spacing(const KdTree<3>& tree, const PointsRef<3>& points) {
  const Index step = std::max<Index>(1, points.cols() / spacings_asked);
  double sum = 0, count = 0;
  for (Index i = 0; i < points.cols(); i += step, ++count) sum += std::pow(spacing_at(tree, points, i), 2);
  return sum / count;
}

}  // namespace

std::vector<Index> nearest_points(const KdTree<3>& tree, const PointsRef<3>& queries) {
  std::vector<Index> nearest(queries.cols());
  parallel_for(queries.cols(), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      double squared = 0;
      tree.nearest(queries.col(i), 1, &nearest[i], &squared);
    }
  });
  return nearest;
}

double spacing_at(const KdTree<3>& tree, const PointsRef<3>& points, Index i) {
  std::array<Index, spacing_neighbors + 1> index{};
  std::array<double, spacing_neighbors + 1> squared{};
  const Index found = tree.nearest(points.col(i), spacing_neighbors + 1, index.data(), squared.data());
  if (found == 1) return 0;
  double sum = 0;
  for (Index k = 1; k < found; ++k) sum += std::sqrt(squared[k]);
  return sum / static_cast<double>(found - 1);
}

std::vector<Index> component_labels(const Mesh& mesh, Index& count) {
  DisjointSets sets(static_cast<std::size_t>(mesh.vertices.cols()));
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int c = 1; c < 3; ++c)
      sets.unite(static_cast<std::uint32_t>(mesh.triangles(0, t)), static_cast<std::uint32_t>(mesh.triangles(c, t)));
  std::vector<Index> label(mesh.vertices.cols());
  count = 0;
  for (std::uint32_t v = 0; v < label.size(); ++v) {
    const std::uint32_t first = sets.find(v);
    label[v] = first == v ? count++ : label[first];
  }
  return label;
}

void DataSupport::add(const DataSupport& other) {
  area += other.area;
  samples += other.samples;
  sample_area += other.sample_area;
  beside_others += other.beside_others;
}

// Points farther than `distance` from all other components count for the largest one, so that most need no search.
std::vector<DataSupport> data_support(const Mesh& mesh, const std::vector<Index>& label, Index count,
                                      const PointsRef<3>& points) {
  const std::vector<double> area = areas(mesh, label, count);
  const double density = static_cast<double>(points.cols()) / std::accumulate(area.begin(), area.end(), 0.0);
  const auto largest = std::max_element(area.begin(), area.end()) - area.begin();
  const double distance = near_component / std::sqrt(density);
  std::vector<Index> others;
  for (std::size_t v = 0; v < label.size(); ++v)
    if (label[v] != largest) others.push_back(static_cast<Index>(v));
  const Points<3> other_vertices = mesh.vertices(Eigen::all, others);
  const KdTree<3> other_tree(other_vertices);
  const std::vector<Index> open = ids_within(other_tree, points, distance);
  const std::vector<Index> rivals = ids_within(other_tree, mesh.vertices, 2 * distance);
  const Points<3> rival_vertices = mesh.vertices(Eigen::all, rivals);
  const KdTree<3> rival_tree(rival_vertices);
  std::vector<DataSupport> supports(count);
  for (Index c = 0; c < count; ++c) supports[c].area = area[c];
  supports[largest].samples = static_cast<double>(points.cols()) - static_cast<double>(open.size());
  const Points<3> contested = points(Eigen::all, open);
  const std::vector<Index> order = morton_order<3>(contested);
  const std::vector<Index> nearest = nearest_points(rival_tree, contested(Eigen::all, order));
  std::vector<Index> component(points.cols(), largest);  // of each point
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const Index c = component[open[order[i]]] = label[rivals[nearest[i]]];
    supports[c].samples += 1;
  }
  const auto is_small = [](const DataSupport& s) { return s.samples >= fewest_samples && s.samples < small; };
  const auto is_asked = [&](const DataSupport& s) {
    return is_small(s) || (s.samples >= small && s.samples < expected_share * density * s.area);
  };
  if (std::none_of(supports.begin(), supports.end(), is_asked)) return supports;
  const KdTree<3> tree(points);
  const double usual = density * mean_squared_spacing(tree, points);
  std::vector<Index> near;
  for (Index i = 0; i < points.cols(); ++i) {
    const Index c = component[i];
    if (!is_asked(supports[c])) continue;
    const double spacing = spacing_at(tree, points, i);
    supports[c].sample_area += spacing * spacing / usual;
    if (!is_small(supports[c])) continue;
    tree.within(points.col(i), beside * spacing, near);
    if (std::any_of(near.begin(), near.end(), [&](Index j) { return component[j] != c; }))
      supports[c].beside_others += 1;
  }
  return supports;
}

std::vector<char> components_with_data(const std::vector<DataSupport>& supports) {
  DataSupport all;
  for (const DataSupport& s : supports) all.add(s);
  const double density = all.samples / all.area;
  std::vector<char> keep;
  for (const DataSupport& s : supports) {
    const bool dense = s.samples >= fewest_samples && s.samples >= expected_share * density * s.area;
    const bool sparse = s.samples >= small && s.sample_area >= expected_share * s.area;
    const bool bubble = s.samples < small && s.sample_area > crowded * s.area;
    keep.push_back((dense && !bubble) || sparse ? 1 : 0);
  }
  const auto fewer = [](const DataSupport& a, const DataSupport& b) { return a.samples < b.samples; };
  keep[std::max_element(supports.begin(), supports.end(), fewer) - supports.begin()] = 1;
  return keep;
}

Index count_shards(const std::vector<DataSupport>& supports, const std::vector<char>& keep) {
  Index count = 0;
  for (std::size_t c = 0; c < supports.size(); ++c)
    count += keep[c] != 0 && supports[c].samples < small && supports[c].beside_others > 0 ? 1 : 0;
  return count;
}

}  // namespace csrbf
