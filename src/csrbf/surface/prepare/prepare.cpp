#include "csrbf/surface/prepare/prepare.hpp"

#include "csrbf/approx/samples/missing_marks.hpp"
#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/coincident_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/surface/prepare/clutter.hpp"
#include "csrbf/surface/prepare/find_normals.hpp"
#include "csrbf/surface/prepare/flat_ends.hpp"
#include "csrbf/surface/prepare/rows.hpp"
#include "csrbf/surface/prepare/slice_stack.hpp"
#include "csrbf/surface/prepare/volumes.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index neighbors = 9;             // for spacing: enough to average, few enough to stay local
constexpr double link_length = 4;          // in spacings: points closer than this belong to one cluster
constexpr double stray_sparseness = 3;     // a cluster is stray if its spacing is this many times the median one
constexpr double stray_share = 0.005;      // ... and it has less than this share of the points
constexpr Index fewest_sparse = 64;        // points of a sparse body, as components_with_data() asks ...
constexpr Index fewest_of_piece = 8;       // ... and of a piece of a sparse part
constexpr double beside = 2;               // usual distances to the neighbours there, that it may be away; by hand
constexpr Index fewest_on_component = 30;  // points: smaller clusters are not treated as parts
constexpr double outliers_share = 0.02;    // of the points: clusters of more are no outliers
constexpr double as_dense = 1.5;           // usual spacings: sparser clusters are not of the same density
constexpr double far_strays = 0.1;  // of the diagonal: a smaller cloud without stray points gets new unit coordinates

using Region = std::optional<Box<3>>;

// Those of the points that warnings count: in the region, if there is one, for others belong to other tiles, and far
// ones are few and sparse on purpose.
Index count_in(const Region& region, const PointCloud& input, const std::vector<Index>& ids) {
  if (!region) return std::ssize(ids);
  return std::count_if(ids.begin(), ids.end(), [&](Index i) { return region->contains(input.points.col(i)); });
}

// Indices of the finite points, the first of each group of equal ones; `normals` gets the sum of the group's normals.
std::vector<Index> distinct_points(const PointCloud& input, const Region& region, Points<3>& normals,
                                   std::vector<std::string>& warnings) {
  const std::vector<Index> first = first_coincident<3>(input.points);
  std::vector<Index> kept, merged;
  Index non_finite = 0;
  for (Index i = 0; i < input.size(); ++i) {
    if (!input.points.col(i).allFinite()) {
      ++non_finite;
    } else if (first[i] == i) {
      kept.push_back(i);
    } else {
      merged.push_back(i);
      if (normals.cols() > 0) normals.col(first[i]) += normals.col(i);
    }
  }
  warn(warnings, non_finite, "points with NaN or infinite coordinates dropped");
  warn(warnings, count_in(region, input, merged), "duplicate points merged");
  return kept;
}

void require_spread(const Points<3>& y) {
  const Point<3> mean = y.rowwise().mean();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (Index i = 0; i < y.cols(); ++i) covariance += (y.col(i) - mean) * (y.col(i) - mean).transpose();
  covariance /= static_cast<double>(y.cols());
  const Eigen::Vector3d spread = symmetric_eigen(covariance).values;
  constexpr double rounding = 1e-12;  // of coordinates with six digits, squared
  if (!(spread[1] > rounding * spread[2]))
    throw InvalidInput(
        "reconstruct: points: all lie on one line; a surface needs points that spread in at least two directions");
}

// Whether j is a neighbour of i. A stray point has neighbours on the surface, but is a neighbour of none of them.
bool is_neighbor(const NeighborTable& near, Index i, Index j) {
  return std::find(near.of(i).begin(), near.of(i).end(), static_cast<std::uint32_t>(j)) != near.of(i).end();
}

// Clusters of points linked by distances that are short for both.
DisjointSets link(const Points<3>& points, const NeighborTable& near, const std::vector<double>& reach) {
  DisjointSets clusters(reach.size());
  for (Index i = 0; i < points.cols(); ++i)
    for (const std::uint32_t other : near.of(i)) {
      const auto id = static_cast<std::uint32_t>(i);
      if (other < id || clusters.find(other) == clusters.find(id)) continue;  // done before, or already linked
      const double shorter = std::min(reach[id], reach[other]);
      if ((points.col(i) - points.col(other)).squaredNorm() <= link_length * link_length * shorter * shorter &&
          is_neighbor(near, other, i))
        clusters.unite(id, other);
    }
  return clusters;
}

// Points to keep, and their clusters, as positions in `ids`, without the largest and those that are too small.
struct Kept {
  std::vector<Index> ids;
  std::vector<std::vector<Index>> components;
  std::vector<Index> in_volumes;  // points that are not kept because their cluster is no surface
};

std::vector<std::vector<Index>> find_components(DisjointSets& clusters, const std::vector<Index>& ids) {
  std::map<std::uint32_t, Index> size;
  for (const Index i : ids) ++size[clusters.find(static_cast<std::uint32_t>(i))];
  const auto smaller = [](const auto& a, const auto& b) { return a.second < b.second; };
  const std::uint32_t largest = std::max_element(size.begin(), size.end(), smaller)->first;
  std::map<std::uint32_t, std::vector<Index>> components;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const std::uint32_t cluster = clusters.find(static_cast<std::uint32_t>(ids[k]));
    if (cluster != largest && size[cluster] >= fewest_on_component)
      components[cluster].push_back(static_cast<Index>(k));
  }
  std::vector<std::vector<Index>> result;
  result.reserve(components.size());
  for (auto& component : components) result.push_back(std::move(component.second));
  return result;
}

// Drops small dense clusters that fill a volume. `reach`: of points, as far as all_but_stray() looks.
void drop_volumes(const Points<3>& points, const NeighborTable& near, const std::vector<double>& reach, double usual,
                  Kept& kept) {
  std::vector<Index> rest = kept.ids;
  for (const auto& component : kept.components)
    for (const Index k : component) rest[k] = -1;
  std::erase(rest, -1);
  std::vector<char> drop(kept.ids.size(), 0);
  for (const auto& component : kept.components) {
    if (static_cast<double>(component.size()) > outliers_share * static_cast<double>(kept.ids.size())) continue;
    std::vector<Index> ids;
    for (const Index k : component) ids.push_back(kept.ids[k]);
    std::vector<double> spacings;
    for (const Index i : ids) spacings.push_back(reach[i]);
    if (median(std::move(spacings)) > as_dense * usual || !fill_volume(points, near, ids, rest)) continue;
    for (const Index k : component) drop[k] = 1;
  }
  std::vector<Index> ids;
  for (std::size_t k = 0; k < drop.size(); ++k) (drop[k] != 0 ? kept.in_volumes : ids).push_back(kept.ids[k]);
  kept.ids = std::move(ids);
}

// Adds the clusters, all much sparser than usual, that are surface: bodies with few samples and, if most of the points
// beyond `sparse_reach` are on the surface, pieces beside a part that is as sparse, which chance separates from it.
void keep_sparse_parts(const Points<3>& points, const Points<3>& normals, const NeighborTable& near,
                       const std::vector<double>& reach, double sparse_reach,
                       const std::map<std::uint32_t, std::vector<Index>>& clusters, std::vector<Index>& kept) {
  std::vector<const std::vector<Index>*> pieces;
  Index left = 0;
  for (const auto& [cluster, ids] : clusters) {
    if (std::ssize(ids) >= fewest_sparse && lie_on_sheets(points, normals, near, ids))
      kept.insert(kept.end(), ids.begin(), ids.end());
    else
      pieces.push_back(&ids);
  }
  for (const std::vector<Index>* ids : pieces) left += std::ssize(*ids);
  std::vector<Index> part;
  std::copy_if(kept.begin(), kept.end(), std::back_inserter(part), [&](Index i) { return reach[i] > sparse_reach; });
  if (std::ssize(part) < std::max(fewest_sparse, left)) return;
  const auto usual_reach = [&](const std::vector<Index>& ids) {
    std::vector<double> all;
    for (const Index i : ids) all.push_back(reach[i]);
    return median(std::move(all));
  };
  const double usual = usual_reach(part);
  const KdTree<3> tree(chosen_points<3>(points, part));
  const auto is_beside = [&](Index i) {
    Index nearest = 0;
    double r2 = 0;
    tree.nearest(points.col(i), 1, &nearest, &r2);
    return r2 <= beside * beside * usual * usual;
  };
  for (const std::vector<Index>* ids : pieces)
    if (std::ssize(*ids) >= fewest_of_piece && std::any_of(ids->begin(), ids->end(), is_beside) &&
        usual_reach(*ids) <= as_dense * usual && may_lie_on_sheets(points, normals, near, *ids))
      kept.insert(kept.end(), ids->begin(), ids->end());
}

// The points to keep: clusters linked by short distances are stray if they are much sparser than usual, small and no
// sparse part of the surface, or, without a region, if they fill a volume: far from one, thinned surfaces seem to.
Kept all_but_stray(const Points<3>& points, const Points<3>& normals, const NeighborTable& near, const Region& region) {
  const auto n = static_cast<std::size_t>(points.cols());
  std::vector<double> reach(n);
  for (Index i = 0; i < points.cols(); ++i) reach[i] = (points.col(i) - points.col(near.of(i)[near.k / 2])).norm();
  const double usual = median(std::vector(reach));
  DisjointSets clusters = link(points, near, reach);
  std::vector<Index> size(n, 0);
  std::vector<double> sum(n, 0);
  for (std::uint32_t i = 0; i < n; ++i) {
    ++size[clusters.find(i)];
    sum[clusters.find(i)] += reach[i];
  }
  Kept kept;
  std::map<std::uint32_t, std::vector<Index>> sparse;
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t cluster = clusters.find(i);
    const auto count = static_cast<double>(size[cluster]);
    if (count >= stray_share * static_cast<double>(n) || sum[cluster] <= stray_sparseness * usual * count)
      kept.ids.push_back(i);
    else
      sparse[cluster].push_back(i);
  }
  keep_sparse_parts(points, normals, near, reach, stray_sparseness * usual, sparse, kept.ids);
  std::sort(kept.ids.begin(), kept.ids.end());
  if (kept.ids.empty()) return kept;
  kept.components = find_components(clusters, kept.ids);
  if (kept.components.empty() || region) return kept;
  drop_volumes(points, near, reach, usual, kept);
  if (!kept.in_volumes.empty()) kept.components = find_components(clusters, kept.ids);
  return kept;
}

// Puts the given points of the input into unit coordinates and Morton order, and finds their neighbours.
NeighborTable place(const PointCloud& input, std::vector<Index> ids, PreparedCloud& result) {
  Points<3> points = input.points(Eigen::all, ids);
  const Box<3> box = bounding_box<3>(points);
  result.origin = box.lo + 0.5 * (box.hi - box.lo);
  result.scale = (box.hi - box.lo).stableNorm();
  for (Index i = 0; i < points.cols(); ++i) points.col(i) = (points.col(i) - result.origin) / result.scale;
  const std::vector<Index> order = morton_order<3>(points);
  result.source = std::move(ids);
  result.source = result.sources_of(order);
  result.cloud.points = points(Eigen::all, order);  // must not move in memory: the tree refers to it
  result.tree = std::make_unique<const KdTree<3>>(result.cloud.points);
  return make_neighbor_table(result.cloud.points, *result.tree, neighbors);
}

// The same without outliers scattered all over the space.
NeighborTable place_all_but_clutter(const PointCloud& input, const Region& region, const std::vector<Index>& ids,
                                    PreparedCloud& result) {
  NeighborTable near = place(input, ids, result);
  const double density = clutter_density(result.cloud.points, *result.tree, near);
  if (density == 0) return near;
  const std::vector<Index> kept =
      result.sources_of(all_but_clutter(result.cloud.points, unit_normals(input.normals, result.source), density));
  warn(result.warnings, count_in(region, input, result.source) - count_in(region, input, kept),
       "points scattered around the surface left out");
  return place(input, kept, result);
}

// Drops stray points. If the rest is much smaller, it gets new unit coordinates: far points would cost all others
// precision.
NeighborTable place_all_but_stray(const PointCloud& input, const Region& region, const std::vector<Index>& ids,
                                  PreparedCloud& result) {
  NeighborTable near = place_all_but_clutter(input, region, ids, result);
  const Index before = count_in(region, input, result.source);
  Index in_volumes = 0;
  for (bool far = true; far;) {
    Kept kept = all_but_stray(result.cloud.points, unit_normals(input.normals, result.source), near, region);
    in_volumes += std::ssize(kept.in_volumes);
    const std::vector<Index>& used = kept.ids;
    if (used.size() < 4) break;
    result.components = std::move(kept.components);
    if (std::ssize(used) == result.cloud.size()) break;
    Points<3> left = result.cloud.points(Eigen::all, used);
    result.source = result.sources_of(used);
    far = bounding_box<3>(left).diagonal() < far_strays;
    if (far) {
      near = place(input, std::move(result.source), result);
    } else {
      result.cloud.points = std::move(left);
      result.tree = std::make_unique<const KdTree<3>>(result.cloud.points);
      near = make_neighbor_table(result.cloud.points, *result.tree, near, used);
    }
  }
  require_spread(result.cloud.points);  // not before: a stray point may be so far away that all others seem one
  warn(result.warnings, before - count_in(region, input, result.source) - in_volumes, "stray points dropped");
  warn(result.warnings, in_volumes, "points dropped that fill volumes away from the surface, as outliers do");
  return near;
}

// Several points with a coordinate that marks missing values, such as -9999, are none; a single one is a stray point.
// Smaller marks may be places.
std::vector<Index> all_but_missing(const PointCloud& input, std::vector<Index> ids, const Region& region,
                                   std::vector<std::string>& warnings) {
  constexpr double smallest = 9999;
  for (Index axis = 0; axis < 3; ++axis) {
    const Eigen::VectorXd places = input.points(axis, ids).transpose();
    const std::optional<double> mark = value_beyond_all_others(places);
    if (!mark || !is_usual_mark(*mark) || !(std::abs(*mark) >= smallest)) continue;
    if ((places.array() == *mark).count() < 2) continue;
    std::vector<Index> kept;
    std::copy_if(ids.begin(), ids.end(), std::back_inserter(kept),
                 [&](Index i) { return input.points(axis, i) != *mark; });
    std::ostringstream text;
    text << "points left out whose "
         << "xyz"[axis] << " is " << *mark << ", as where values are missing";
    warn(warnings, count_in(region, input, ids) - count_in(region, input, kept), text.str());
    ids = std::move(kept);
  }
  return ids;
}

// What is known of points that may lie on slices.
struct Slices {
  std::optional<Point<3>> normal;  // of their planes, if there are any
  std::vector<Index> crowded;      // points left out of rows, and the others, before more points were dropped
};

// The same with no more points in rows than between them.
NeighborTable place_all_but_crowded_rows(const PointCloud& input, const Region& region, const std::vector<Index>& ids,
                                         PreparedCloud& result, Slices& slices) {
  NeighborTable near = place_all_but_stray(input, region, ids, result);
  slices.normal = normal_of_slices(result.cloud.points, near);
  const std::vector<Index> kept = result.sources_of(all_but_crowded_rows(result.cloud.points, *result.tree));
  if (kept.empty()) return near;
  warn(result.warnings, count_in(region, input, result.source) - count_in(region, input, kept),
       "points left out, for rows of points are denser than what is between them");
  if (slices.normal) slices.crowded = result.source;
  return place_all_but_stray(input, region, kept, result);
}

// Stray points, in unit coordinates.
Points<3> stray_points(const PointCloud& input, const std::vector<Index>& all, const Slices& slices,
                       const PreparedCloud& result) {
  std::vector<char> used(static_cast<std::size_t>(input.size()), 0);
  for (const Index i : result.source) used[i] = 1;
  for (const Index i : slices.crowded) used[i] = 1;
  std::vector<Index> ids;
  std::copy_if(all.begin(), all.end(), std::back_inserter(ids), [&](Index i) { return used[i] == 0; });
  return (input.points(Eigen::all, ids).colwise() - result.origin) / result.scale;
}

// Adds samples where a solid on slices goes on at the ends of the stack; of a region says only that it does.
void close_ends(PreparedCloud& result, const PointCloud& input, const std::vector<Index>& all, const Region& region,
                const Slices& slices) {
  OrientedPoints& cloud = result.cloud;
  const OrientedPoints ends = flat_ends(cloud, *slices.normal, stray_points(input, all, slices, result));
  if (ends.size() == 0) return;
  if (region) {
    for (Index i = 0; i < ends.size(); ++i)
      if (region->contains(result.origin + result.scale * ends.points.col(i))) {
        result.warnings.emplace_back(
            "the object goes on at an end of the stack of slices: left as it is, for flat ends are only put on whole "
            "clouds");
        return;
      }
    return;
  }
  Points<3> points(3, cloud.size() + ends.size()), normals(3, cloud.size() + ends.size());
  points << cloud.points, ends.points;
  normals << cloud.normals, ends.normals;
  cloud.points = std::move(points);
  cloud.normals = std::move(normals);
  result.tree = std::make_unique<const KdTree<3>>(cloud.points);
  cloud.spacing = local_spacing(cloud.normals, make_neighbor_table(cloud.points, *result.tree, neighbors));
  result.warnings.emplace_back(
      "the object goes on at an end of the stack of slices: closed by a flat end half a spacing beyond, or where "
      "there are samples of its cap");
}

}  // namespace

std::vector<Index> PreparedCloud::sources_of(const std::vector<Index>& points) const {
  std::vector<Index> result;
  result.reserve(points.size());
  for (const Index i : points) result.push_back(source[i]);
  return result;
}

PreparedCloud prepare(const PointCloud& input, Normals source, const Progress& progress, const Region& region) {
  report(progress, "prepare", 0);
  require(input.normals.cols() == 0 || input.has_normals(), "reconstruct", "normals", input.normals.cols(),
          "must be one per point, or none");
  require(source != Normals::file || input.has_normals(), "reconstruct", "normals", "file",
          "the input has no normals; use estimate or auto");
  PreparedCloud result;
  Points<3> normals = input.normals;
  for (Index i = 0; i < normals.cols(); ++i)
    if (!normals.col(i).allFinite()) normals.col(i).setZero();
  const std::vector<Index> kept =
      all_but_missing(input, distinct_points(input, region, normals, result.warnings), region, result.warnings);
  require(kept.size() >= 4, "reconstruct", "points", kept.size(),
          "too few distinct finite points; at least 4 are needed");

  Slices slices;
  const NeighborTable near = place_all_but_crowded_rows(input, region, kept, result, slices);
  report(progress, "prepare", 0.6);
  if (input.has_normals()) result.cloud.normals = normals(Eigen::all, result.source);
  find_normals(result, near, source, input.has_normals(), region, progress);
  result.cloud.spacing = local_spacing(result.cloud.normals, near);
  turn_outward(result, source);
  if (slices.normal) close_ends(result, input, kept, region, slices);
  for (const Index i : result.source) result.bounds.add(Point<3>(input.points.col(i)));
  report(progress, "prepare", 1);
  return result;
}

}  // namespace csrbf
