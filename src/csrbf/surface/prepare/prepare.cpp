#include "csrbf/surface/prepare/prepare.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"
#include "csrbf/spatial/coincident_points.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/surface/estimate_normals.hpp"
#include "csrbf/surface/normals/given_normals.hpp"
#include "csrbf/surface/normals/inward_parts.hpp"
#include "csrbf/surface/normals/neighbor_table.hpp"
#include "csrbf/surface/normals/orient_normals.hpp"
#include "csrbf/surface/normals/plane_normals.hpp"
#include "csrbf/surface/normals/winding_sides.hpp"
#include "csrbf/surface/prepare/clutter.hpp"

#include <map>
#include <utility>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index neighbors = 9;             // for spacing: enough to average, few enough to stay local
constexpr double link_length = 4;          // in spacings: points closer than this belong to one cluster
constexpr double stray_sparseness = 3;     // a cluster is stray if its spacing is this many times the median one
constexpr double stray_share = 0.005;      // ... and it has less than this share of the points
constexpr Index fewest_on_component = 30;  // points: smaller clusters are not treated as parts
constexpr double far_strays = 0.1;  // of the diagonal: a smaller cloud without stray points gets new unit coordinates
constexpr double usual_contradictions = 5e-4;     // share of opposite neighbouring normals that is not examined
constexpr Index examined = 50'000;                // points of a large cloud on which re-orientation is tried first
constexpr double clearly_better = 0.8;            // largest ratio of its defect to that of the given normals
constexpr double has_inside = 0.15;               // mean winding number below which there is no solid
constexpr double remaining_contradictions = 0.2;  // share of contradictions left by a successful re-orientation at most

void warn(std::vector<std::string>& warnings, Index count, const std::string& text) {
  if (count > 0) warnings.push_back(std::to_string(count) + " " + text);
}

// Indices of the finite points, the first of each group of equal ones; `normals` gets the sum of the group's normals.
std::vector<Index> distinct_points(const PointCloud& input, Points<3>& normals, std::vector<std::string>& warnings) {
  const std::vector<Index> first = first_coincident<3>(input.points);
  std::vector<Index> kept;
  Index non_finite = 0;
  for (Index i = 0; i < input.size(); ++i) {
    if (!input.points.col(i).allFinite()) {
      ++non_finite;
    } else if (first[i] == i) {
      kept.push_back(i);
    } else if (normals.cols() > 0) {
      normals.col(first[i]) += normals.col(i);
    }
  }
  warn(warnings, non_finite, "points with NaN or infinite coordinates dropped");
  warn(warnings, input.size() - non_finite - static_cast<Index>(kept.size()), "duplicate points merged");
  return kept;
}

void require_spread(const Points<3>& y) {
  const Point<3> mean = y.rowwise().mean();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (Index i = 0; i < y.cols(); ++i) covariance += (y.col(i) - mean) * (y.col(i) - mean).transpose();
  covariance /= static_cast<double>(y.cols());
  const Eigen::Vector3d spread = symmetric_eigen(covariance).values;
  if (!(spread[1] > 1e-14 * spread[2]))
    throw InvalidInput(
        "reconstruct: points: all lie on one line; a surface needs points that spread in at least two directions");
}

// Spacing s with s^2 = area per sample: the area of the disc out to the farthest neighbour, divided by the number of
// neighbours on this sheet.
Eigen::VectorXd local_spacing(const Points<3>& normals, const NeighborTable& near) {
  Eigen::VectorXd spacing(near.size());
  for (Index i = 0; i < near.size(); ++i) {
    const auto on_sheet = [&](std::uint32_t j) {
      return normals.cols() == 0 || normals.col(i).dot(normals.col(j)) > 0;
    };
    const std::ptrdiff_t same_sheet = std::count_if(near.of(i).begin(), near.of(i).end(), on_sheet);
    spacing[i] =
        near.reach[i] * std::sqrt(std::numbers::pi / static_cast<double>(std::max(std::ptrdiff_t{1}, same_sheet)));
  }
  return spacing;
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

// The points to keep: clusters of points linked by short distances are stray if they are much sparser than usual and
// small.
Kept all_but_stray(const Points<3>& points, const NeighborTable& near) {
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
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t cluster = clusters.find(i);
    const auto count = static_cast<double>(size[cluster]);
    if (count >= stray_share * static_cast<double>(n) || sum[cluster] <= stray_sparseness * usual * count)
      kept.ids.push_back(i);
  }
  if (!kept.ids.empty()) kept.components = find_components(clusters, kept.ids);
  return kept;
}

std::vector<Index> select(const std::vector<Index>& entries, const std::vector<Index>& ids) {
  std::vector<Index> chosen;
  chosen.reserve(ids.size());
  for (const Index i : ids) chosen.push_back(entries[i]);
  return chosen;
}

// Normalises given normals; returns how many are missing (zero or not finite).
Index normalize(Points<3>& normals) {
  Index missing = 0;
  for (Index i = 0; i < normals.cols(); ++i) {
    const double length = normals.col(i).stableNorm();
    if (length > 0 && std::isfinite(length)) {
      normals.col(i) /= length;
    } else {
      normals.col(i).setZero();
      ++missing;
    }
  }
  return missing;
}

// Puts the given points of the input into unit coordinates and Morton order, and finds their neighbours.
NeighborTable place(const PointCloud& input, std::vector<Index> ids, PreparedCloud& result) {
  Points<3> points = input.points(Eigen::all, ids);
  const Box<3> box = bounding_box<3>(points);
  result.origin = box.lo + 0.5 * (box.hi - box.lo);
  result.scale = (box.hi - box.lo).stableNorm();
  for (Index i = 0; i < points.cols(); ++i) points.col(i) = (points.col(i) - result.origin) / result.scale;
  require_spread(points);
  const std::vector<Index> order = morton_order<3>(points);
  result.source = select(ids, order);
  result.cloud.points = points(Eigen::all, order);  // must not move in memory: the tree refers to it
  result.tree = std::make_unique<const KdTree<3>>(result.cloud.points);
  return make_neighbor_table(result.cloud.points, *result.tree, neighbors);
}

// The same without outliers scattered all over the space.
NeighborTable place_all_but_clutter(const PointCloud& input, const std::vector<Index>& ids, PreparedCloud& result) {
  NeighborTable near = place(input, ids, result);
  const double density = clutter_density(result.cloud.points, near);
  if (density == 0) return near;
  Points<3> normals(3, 0);
  if (input.has_normals()) {
    normals = input.normals(Eigen::all, result.source);
    normalize(normals);
  }
  const std::vector<Index> kept = all_but_clutter(result.cloud.points, normals, density);
  warn(result.warnings, result.cloud.size() - std::ssize(kept), "points scattered around the surface left out");
  return place(input, select(result.source, kept), result);
}

// Drops stray points. If the rest is much smaller, it gets new unit coordinates: far points would cost all others
// precision.
NeighborTable place_all_but_stray(const PointCloud& input, const std::vector<Index>& ids, PreparedCloud& result) {
  NeighborTable near = place_all_but_clutter(input, ids, result);
  Index stray = 0;
  for (bool far = true; far;) {
    Kept kept = all_but_stray(result.cloud.points, near);
    const std::vector<Index>& used = kept.ids;
    if (used.size() < 4) break;
    result.components = std::move(kept.components);
    const Index dropped = result.cloud.size() - static_cast<Index>(used.size());
    if (dropped == 0) break;
    stray += dropped;
    Points<3> left = result.cloud.points(Eigen::all, used);
    result.source = select(result.source, used);
    far = bounding_box<3>(left).diagonal() < far_strays;
    if (far) {
      near = place(input, std::move(result.source), result);
    } else {
      result.cloud.points = std::move(left);
      result.tree = std::make_unique<const KdTree<3>>(result.cloud.points);
      near = make_neighbor_table(result.cloud.points, *result.tree, near, used);
    }
  }
  warn(result.warnings, stray, "stray points dropped");
  return near;
}

// Fills in missing normals: estimated without orientation, flipped to agree with the nearest given ones.
void fill_missing(const Points<3>& points, Points<3>& normals, const Progress& progress) {
  const Points<3> estimated = estimate_normals(points, {.orient = Orient::none, .progress = progress});
  std::vector<Index> given;
  for (Index i = 0; i < normals.cols(); ++i)
    if (normals.col(i).squaredNorm() > 0) given.push_back(i);
  const Points<3> known = points(Eigen::all, given);
  const KdTree<3> tree(known);
  for (Index i = 0; i < normals.cols(); ++i) {
    if (normals.col(i).squaredNorm() > 0) continue;
    Index nearest = 0;
    double d2 = 0;
    tree.nearest(points.col(i), 1, &nearest, &d2);
    const double side = estimated.col(i).dot(normals.col(given[nearest]));
    normals.col(i) = side < 0 ? Point<3>(-estimated.col(i)) : Point<3>(estimated.col(i));
  }
}

// Share of the pairs of near neighbours whose normals point to opposite sides.
double opposite_neighbors(const Points<3>& normals, const NeighborTable& near) {
  const auto nearest = static_cast<std::size_t>(std::min<Index>(near.k, 4));
  Index pairs = 0, opposite = 0;
  for (Index i = 0; i < normals.cols(); ++i)
    for (const std::uint32_t j : near.of(i).first(nearest)) {
      ++pairs;
      if (normals.col(i).dot(normals.col(j)) < 0) ++opposite;
    }
  return pairs == 0 ? 0 : static_cast<double>(opposite) / static_cast<double>(pairs);
}

// Share of the contradictions among normals that remains after orienting them; 1 if there were hardly any.
double remaining_after_orientation(const Points<3>& points, Points<3>& normals, const Progress& progress) {
  const double contradictions = 1 - orientation_consistency(points, normals);
  if (contradictions < usual_contradictions) return 1;
  orient_normals(points, normals, {.progress = progress});
  return (1 - orientation_consistency(points, normals)) / contradictions;
}

// Whether other normals enclose a solid clearly better than the given ones, or there is none.
bool encloses_better(const OrientedPoints& given, const Points<3>& other, const NeighborTable& near) {
  const WindingSides turned = winding_sides(given.points, other, local_spacing(other, near));
  if (turned.mean < has_inside) return true;
  const WindingSides before = winding_sides(given.points, given.normals, local_spacing(given.normals, near));
  return turned.defect < clearly_better * before.defect;
}

// Flipped regions of given normals disagree along their borders; then another orientation has far fewer disagreements.
// Noise or creases leave about as many in any orientation. In a large cloud, a subset decides which it is. Sheets that
// touch disagree, too, but the given normals enclose a solid at least as well.
void reorient_if_better(PreparedCloud& result, const NeighborTable& near, const Progress& progress) {
  OrientedPoints& cloud = result.cloud;
  if (opposite_neighbors(cloud.normals, near) < usual_contradictions) return;
  if (cloud.size() > 2 * examined) {
    const auto some = Eigen::seq(0, cloud.size() - 1, cloud.size() / examined);
    Points<3> turned = cloud.normals(Eigen::all, some);
    if (remaining_after_orientation(cloud.points(Eigen::all, some), turned, progress) > remaining_contradictions)
      return;
  }
  Points<3> turned = cloud.normals;
  if (remaining_after_orientation(cloud.points, turned, progress) > remaining_contradictions) return;
  if (!encloses_better(cloud, turned, near)) return;
  cloud.normals = std::move(turned);
  result.normals = NormalSource::reoriented;
  result.warnings.push_back("the given normals contradict each other: re-oriented");
}

// Gives the points outside of a region, in the user's coordinates, their normals back. Returns how many others have
// changed.
Index restore_outside(const std::optional<Box<3>>& region, const Points<3>& given, PreparedCloud& result) {
  Index changed = 0;
  for (Index i = 0; i < given.cols(); ++i) {
    if (!region->contains(result.origin + result.scale * result.cloud.points.col(i)))
      result.cloud.normals.col(i) = given.col(i);
    else if (result.cloud.normals.col(i) != given.col(i))
      ++changed;
  }
  return changed;
}

void correct(PreparedCloud& result, const NeighborTable& near, const std::optional<Box<3>>& region,
             const Progress& progress) {
  const Points<3> given = region ? result.cloud.normals : Points<3>(3, 0);
  NormalCorrection done = correct_normals(result.cloud.points, *result.tree, near, result.cloud.normals);
  if (region) {
    const Index changed = restore_outside(region, given, result);
    done.corrected = std::min(done.corrected, changed);
    done.turned = std::min(done.turned, changed);
  }
  warn(result.warnings, done.turned, "normals that point against their neighbours turned");
  if (done.corrected == 0) return;
  const auto degrees = std::lround(done.error * 180 / std::numbers::pi);
  warn(result.warnings, done.corrected,
       "normals have errors of about " + std::to_string(degrees) +
           " degrees: corrected by the positions and by each other");
  result.normals = NormalSource::corrected;
  orient_normals(result.cloud.points, result.cloud.normals, {.signs_given = true, .progress = progress});
}

// Normals of planes through few neighbours are estimated again: they repeat the noise of the positions, which looks
// like detail then. They keep their side, unless the new ones enclose a solid clearly better.
void replace_plane_normals(PreparedCloud& result, const NeighborTable& near, const Progress& progress) {
  OrientedPoints& cloud = result.cloud;
  const Index neighbors = neighbors_of_planes(cloud.points, *result.tree, cloud.normals);
  if (neighbors == 0) return;
  const Points<3> estimated = estimate_normals(cloud.points, {.progress = progress});
  cloud.normals = on_given_side(estimated, cloud.normals, near);
  if (encloses_better(cloud, estimated, near)) cloud.normals = estimated;
  result.normals = NormalSource::corrected;
  result.warnings.push_back("the given normals are those of planes through " + std::to_string(neighbors) +
                            " neighbours: estimated again");
}

void find_normals(PreparedCloud& result, const NeighborTable& near, Normals source, bool given,
                  const std::optional<Box<3>>& region, const Progress& progress) {
  OrientedPoints& cloud = result.cloud;
  bool usable = given && source != Normals::estimate;
  const Index missing = usable ? normalize(cloud.normals) : 0;
  if (2 * missing > cloud.size()) {
    result.warnings.push_back("most normals are zero: all estimated");
    usable = false;
  }
  if (!usable) {
    cloud.normals = estimate_normals(cloud.points, {.progress = progress});
    result.normals = NormalSource::estimated;
    return;
  }
  warn(result.warnings, missing, "missing normals estimated");
  if (missing > 0) fill_missing(cloud.points, cloud.normals, progress);
  if (source != Normals::automatic) return;
  replace_plane_normals(result, near, progress);
  if (result.normals == NormalSource::file) correct(result, near, region, progress);
  if (result.normals == NormalSource::file) reorient_if_better(result, near, progress);
}

// Given normals that consistently point inward are not contradictory, but would make the outside solid.
void turn_outward(PreparedCloud& result, Normals source) {
  if (result.normals != NormalSource::file && result.normals != NormalSource::corrected) return;
  const std::vector<bool> inward = inward_parts(result.cloud, result.components);
  const auto count = std::count(inward.begin(), inward.end(), true);
  if (count == 0) return;
  const std::string where = count == static_cast<std::ptrdiff_t>(inward.size()) ? "" : " on some parts";
  if (source == Normals::file) {
    result.warnings.push_back("the given normals point inward" + where + "; automatic normals would turn them");
    return;
  }
  std::vector<signed char> sign(result.cloud.size(), inward.back() ? -1 : 1);
  for (std::size_t k = 0; k < result.components.size(); ++k)
    for (const Index i : result.components[k]) sign[i] = inward[k] ? -1 : 1;
  for (Index i = 0; i < result.cloud.size(); ++i) result.cloud.normals.col(i) *= sign[i];
  result.normals = NormalSource::reoriented;
  result.warnings.push_back("the given normals point inward" + where + ": turned");
}

}  // namespace

PreparedCloud prepare(const PointCloud& input, Normals source, const Progress& progress,
                      const std::optional<Box<3>>& region) {
  report(progress, "prepare", 0);
  require(input.normals.cols() == 0 || input.has_normals(), "reconstruct", "normals", input.normals.cols(),
          "must be one per point, or none");
  require(source != Normals::file || input.has_normals(), "reconstruct", "normals", "file",
          "the input has no normals; use estimate or auto");
  PreparedCloud result;
  Points<3> normals = input.normals;
  for (Index i = 0; i < normals.cols(); ++i)
    if (!normals.col(i).allFinite()) normals.col(i).setZero();
  const std::vector<Index> kept = distinct_points(input, normals, result.warnings);
  require(kept.size() >= 4, "reconstruct", "points", kept.size(),
          "too few distinct finite points; at least 4 are needed");

  const NeighborTable near = place_all_but_stray(input, kept, result);
  report(progress, "prepare", 0.6);
  if (input.has_normals()) result.cloud.normals = normals(Eigen::all, result.source);
  find_normals(result, near, source, input.has_normals(), region, progress);
  result.cloud.spacing = local_spacing(result.cloud.normals, near);
  turn_outward(result, source);
  for (const Index i : result.source) result.bounds.add(Point<3>(input.points.col(i)));
  report(progress, "prepare", 1);
  return result;
}

}  // namespace csrbf
