#include "csrbf/surface/prepare/bridge_gaps.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"
#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/spatial/farthest_points.hpp"

#include <Eigen/Geometry>

#include <numbers>

namespace csrbf {
namespace {

// Which rims are joined. Chosen by hand: stricter values leave gaps open, looser ones join separate bodies.
constexpr Index rim_neighbors = 24;                    // neighbours that decide whether a sample lies on a rim
constexpr double free_angle = 0.6 * std::numbers::pi;  // of the largest sector without neighbours at a rim sample
constexpr double max_openness = 0.4;    // below half a ball (0.5): beyond, the winding number is undecided anyway
constexpr double facing = 0.3;          // least cosine between the gap and the direction a rim faces
constexpr double same_side = 0.3;       // least cosine between normals on both sides of a gap
constexpr double widest_gap = 4;        // widths of the opening
constexpr double same_direction = 0.7;  // least cosine between the directions of successive samples of a rim
constexpr Index shortest_rim = 8;       // samples
constexpr double fewest_joined = 6;     // least number of samples of a component's rim that face another rim ...
constexpr double joined_share = 0.25;   // ... and their least share of it

// The surface across a gap. Chosen by hand.
constexpr Index spline_samples = 150;     // on each side; three conditions each: a dense system of order 900
constexpr double spline_reach = 1.5;      // widths of the opening: how far from the rim they are taken
constexpr double spline_offset = 0.1;     // widths of the opening: distance of the off-surface conditions
constexpr double least_slope = 0.01;      // floor of the squared gradient, which is 1 near samples, in Newton's method
constexpr double coarsest = 0.05;         // widths of the opening: least spacing of the added samples
constexpr double distance_to_data = 1.5;  // spacings between added samples and those of the input ...
constexpr double density = 0.7;           // ... and between each other
constexpr int most_steps = 12;            // of Newton's method
constexpr double convergence = 1e-3;      // spacings: largest residual of an added sample
constexpr Index samples_per_task = 256;   // large enough to hide the cost of a task

// A sample on a rim, and the direction in which the surface is missing.
struct RimSample {
  Index id;
  Point<3> onward;
};

// The rim of a component and the one across the gap.
struct Gap {
  std::vector<Index> near_rim, far_rim;
  double width;   // of the opening
  double length;  // of the gap
};

// The middle of the widest sector without neighbours on the sheet of sample i, if it is wide enough.
std::optional<Point<3>> free_direction(const OrientedPoints& cloud, const KdTree<3>& tree, Index i) {
  std::array<Index, rim_neighbors + 1> near;
  std::array<double, rim_neighbors + 1> d2;
  const Index found = tree.nearest(cloud.points.col(i), rim_neighbors + 1, near.data(), d2.data());
  const Point<3> normal = cloud.normals.col(i), u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<double> angles;
  for (Index k = 0; k < found; ++k) {
    if (near[k] == i || cloud.normals.col(near[k]).dot(normal) <= 0) continue;
    const Point<3> d = cloud.points.col(near[k]) - cloud.points.col(i);
    angles.push_back(std::atan2(d.dot(v), d.dot(u)));
  }
  if (angles.size() < 2) return std::nullopt;
  std::sort(angles.begin(), angles.end());
  double width = angles.front() + 2 * std::numbers::pi - angles.back(), middle = angles.back() + width / 2;
  for (std::size_t k = 1; k < angles.size(); ++k)
    if (angles[k] - angles[k - 1] > width) {
      width = angles[k] - angles[k - 1];
      middle = angles[k - 1] + width / 2;
    }
  if (width < free_angle) return std::nullopt;
  return std::cos(middle) * u + std::sin(middle) * v;
}

// Those that form chains along which the direction turns slowly. Under random sampling, isolated samples, and a few
// around larger holes, lack neighbours on some side all over a surface that has no rim. Samples ascend.
std::vector<RimSample> chains(const OrientedPoints& cloud, const KdTree<3>& tree,
                              const std::vector<RimSample>& samples) {
  DisjointSets sets(samples.size());
  std::array<Index, rim_neighbors + 1> near;
  std::array<double, rim_neighbors + 1> d2;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const Index found = tree.nearest(cloud.points.col(samples[k].id), rim_neighbors + 1, near.data(), d2.data());
    for (const Index i : std::span(near.data(), static_cast<std::size_t>(found))) {
      const auto at =
          std::lower_bound(samples.begin(), samples.end(), i, [](const RimSample& a, Index id) { return a.id < id; });
      if (at == samples.end() || at->id != i || at->onward.dot(samples[k].onward) < same_direction) continue;
      sets.unite(static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(at - samples.begin()));
    }
  }
  std::vector<Index> length(samples.size(), 0);
  for (std::size_t k = 0; k < samples.size(); ++k) ++length[sets.find(static_cast<std::uint32_t>(k))];
  std::vector<RimSample> result;
  for (std::size_t k = 0; k < samples.size(); ++k)
    if (length[sets.find(static_cast<std::uint32_t>(k))] >= shortest_rim) result.push_back(samples[k]);
  return result;
}

// In the order of `ids`, which ascend.
std::vector<RimSample> rim(const OrientedPoints& cloud, const KdTree<3>& tree, const std::vector<Index>& ids) {
  std::vector<std::optional<Point<3>>> onward(ids.size());
  parallel_for(std::ssize(ids), samples_per_task, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) onward[k] = free_direction(cloud, tree, ids[k]);
  });
  std::vector<RimSample> open;
  for (std::size_t k = 0; k < ids.size(); ++k)
    if (onward[k]) open.push_back({ids[k], *onward[k]});
  return chains(cloud, tree, open);
}

// All samples within `reach` of the box of a component, without those on it.
std::vector<Index> surroundings(const OrientedPoints& cloud, const KdTree<3>& tree, const std::vector<Index>& component,
                                double reach) {
  Box<3> box;
  for (const Index i : component) box.add(Point<3>(cloud.points.col(i)));
  std::vector<Index> near, outside;
  tree.within(box.center(), box.diagonal() / 2 + reach, near);
  std::set_difference(near.begin(), near.end(), component.begin(), component.end(), std::back_inserter(outside));
  return outside;
}

// Whether two rims face each other along d.
bool face(const RimSample& from, const RimSample& to, const Point<3>& d) {
  return d.dot(from.onward) > facing * d.norm() && -d.dot(to.onward) > facing * d.norm();
}

// Distance to the nearest sample within `reach` on the other rim that faces back and continues the surface.
std::optional<double> distance_across(const OrientedPoints& cloud, const RimSample& from,
                                      const std::vector<RimSample>& others, double reach) {
  std::optional<double> best;
  for (const RimSample& to : others) {
    const Point<3> d = cloud.points.col(to.id) - cloud.points.col(from.id);
    if (d.norm() < best.value_or(reach) && face(from, to, d) &&
        cloud.normals.col(from.id).dot(cloud.normals.col(to.id)) > same_side)
      best = d.norm();
  }
  return best;
}

// Twice the mean distance of a rim's samples from their centroid.
double width(const OrientedPoints& cloud, const std::vector<RimSample>& samples) {
  const auto count = static_cast<double>(samples.size());
  Point<3> middle = Point<3>::Zero();
  for (const RimSample& sample : samples) middle += cloud.points.col(sample.id) / count;
  double distance = 0;
  for (const RimSample& sample : samples) distance += (cloud.points.col(sample.id) - middle).norm() / count;
  return 2 * distance;
}

double mean_spacing(const OrientedPoints& cloud, const std::vector<Index>& ids) {
  double sum = 0;
  for (const Index i : ids) sum += cloud.spacing[i];
  return sum / static_cast<double>(ids.size());
}

// The gap between a component and the rest, if they belong together.
std::optional<Gap> find_gap(const OrientedPoints& cloud, const KdTree<3>& tree, const std::vector<Index>& component) {
  const std::vector<RimSample> own = rim(cloud, tree, component);
  if (own.empty()) return std::nullopt;
  Gap gap{{}, {}, width(cloud, own), 0};
  const double reach = widest_gap * gap.width;
  const std::vector<RimSample> others = rim(cloud, tree, surroundings(cloud, tree, component, reach));
  std::vector<double> distances;
  for (const RimSample& sample : own)
    if (const auto distance = distance_across(cloud, sample, others, reach)) distances.push_back(*distance);
  const auto facing_samples = static_cast<double>(distances.size());
  if (facing_samples < std::max(fewest_joined, joined_share * static_cast<double>(own.size()))) return std::nullopt;
  gap.length = percentile(distances, 0.5);
  for (const RimSample& sample : own) gap.near_rim.push_back(sample.id);
  for (const RimSample& sample : others) {
    const auto sees = [&](const RimSample& from) {
      const Point<3> d = cloud.points.col(sample.id) - cloud.points.col(from.id);
      return d.norm() < gap.length + gap.width && face(from, sample, d);
    };
    if (std::any_of(own.begin(), own.end(), sees)) gap.far_rim.push_back(sample.id);
  }
  return gap;
}

// Length of the area-weighted mean normal of a component: 0 if it is closed, 1/2 for half a ball, 1 for a flat sheet.
double openness(const OrientedPoints& cloud, const std::vector<Index>& component) {
  Point<3> flux = Point<3>::Zero();
  double area = 0;
  for (const Index i : component) {
    const double a = cloud.spacing[i] * cloud.spacing[i];
    flux += a * cloud.normals.col(i);
    area += a;
  }
  return flux.norm() / area;
}

// Well spread samples of `among` within `reach` of a rim.
std::vector<Index> samples_behind(const OrientedPoints& cloud, const std::vector<Index>& rim,
                                  const std::vector<Index>& among, double reach) {
  const Points<3> edge = cloud.points(Eigen::all, rim);
  const KdTree<3> tree(edge);
  std::vector<Index> near;
  for (const Index i : among) {
    Index nearest = 0;
    double d2 = 0;
    tree.nearest(cloud.points.col(i), 1, &nearest, &d2);
    if (d2 < reach * reach) near.push_back(i);
  }
  std::vector<Index> spread = farthest_points<3>(cloud.points(Eigen::all, near), spline_samples).indices;
  for (Index& i : spread) i = near[i];
  return spread;
}

// The surface of least energy through the samples on both sides of a gap: a triharmonic spline that vanishes at them
// and equals the signed distance at offsets inside and outside.
std::shared_ptr<const Field<3>> spline_across(const OrientedPoints& cloud, const KdTree<3>& tree,
                                              const std::vector<Index>& component, const Gap& gap) {
  const double reach = spline_reach * gap.width, offset = spline_offset * gap.width;
  std::vector<Index> ids = samples_behind(cloud, gap.near_rim, component, reach);
  const std::vector<Index> far =
      samples_behind(cloud, gap.far_rim, surroundings(cloud, tree, component, gap.length + gap.width + reach), reach);
  ids.insert(ids.end(), far.begin(), far.end());
  const Index n = std::ssize(ids);
  Samples<3> samples{Points<3>(3, 3 * n), Eigen::VectorXd(3 * n), {}};
  for (Index k = 0; k < n; ++k) {
    const Index i = ids[k];
    for (const int side : {-1, 0, 1}) {
      samples.points.col(3 * k + 1 + side) = cloud.points.col(i) - side * offset * cloud.normals.col(i);
      samples.values(3 * k + 1 + side, 0) = side * offset;
    }
  }
  return interpolate<3>(samples, {.kernel = "polyharmonic", .parameter = 3}).components.front();
}

// Points between the rims, about four for each sample that the surface across the gap needs.
Points<3> points_between(const OrientedPoints& cloud, const Gap& gap, double spacing) {
  const auto segments = static_cast<Index>(std::ceil(gap.length / spacing));
  const std::size_t pairs = gap.near_rim.size() * gap.far_rim.size();
  const auto wanted = static_cast<std::size_t>(4 * std::numbers::pi * gap.width / spacing);
  const std::size_t stride = 1 + pairs / wanted;
  std::vector<Point<3>> points;
  for (std::size_t pair = 0; pair < pairs; pair += stride) {
    const Point<3> a = cloud.points.col(gap.near_rim[pair % gap.near_rim.size()]);
    const Point<3> b = cloud.points.col(gap.far_rim[pair / gap.near_rim.size()]);
    for (Index k = 1; k < segments; ++k)
      points.push_back(a + static_cast<double>(k) / static_cast<double>(segments) * (b - a));
  }
  Points<3> result(3, static_cast<Index>(points.size()));
  for (Index i = 0; i < result.cols(); ++i) result.col(i) = points[i];
  return result;
}

struct Added {
  Points<3> points, normals;
};

// Moves points onto the zero set of f by Newton's method along the gradient; returns those that converge within
// `reach`, with outward normals.
Added project(const Field<3>& f, const Points<3>& from, double reach, double tolerance) {
  Points<3> x = from;
  Jet<3> jet;
  for (int step = 0; step < most_steps; ++step) {
    jet = f.evaluate(x, Derivatives::gradient);
    for (Index i = 0; i < x.cols(); ++i) {
      const Point<3> g = jet.gradient.col(i);
      x.col(i) -= std::clamp(jet.value[i] / std::max(g.squaredNorm(), least_slope), -reach, reach) * g;
    }
  }
  std::vector<Index> kept;
  for (Index i = 0; i < x.cols(); ++i) {
    if (!(std::abs(jet.value[i]) < tolerance) || (x.col(i) - from.col(i)).norm() > reach) continue;
    kept.push_back(i);
    jet.gradient.col(i) = -jet.gradient.col(i).normalized();
  }
  return {x(Eigen::all, kept), jet.gradient(Eigen::all, kept)};
}

// Adds the samples that are far enough from the existing ones and from each other.
void add_spread(const Added& added, double spacing, PreparedCloud& prepared) {
  OrientedPoints& cloud = prepared.cloud;
  std::vector<Index> free;
  for (Index i = 0; i < added.points.cols(); ++i) {
    Index nearest = 0;
    double d2 = 0;
    prepared.tree->nearest(added.points.col(i), 1, &nearest, &d2);
    if (d2 > distance_to_data * distance_to_data * spacing * spacing) free.push_back(i);
  }
  const FarthestPoints spread = farthest_points<3>(added.points(Eigen::all, free), std::ssize(free));
  Index count = 0;
  while (count < std::ssize(spread.indices) && spread.radii[count] > density * spacing) ++count;
  const Index n = cloud.size();
  cloud.points.conservativeResize(3, n + count);
  cloud.normals.conservativeResize(3, n + count);
  cloud.spacing.conservativeResize(n + count);
  for (Index k = 0; k < count; ++k) {
    const Index i = free[spread.indices[k]];
    cloud.points.col(n + k) = added.points.col(i);
    cloud.normals.col(n + k) = added.normals.col(i);
    cloud.spacing[n + k] = spacing;
  }
  prepared.tree = std::make_unique<const KdTree<3>>(cloud.points);
}

bool join(PreparedCloud& prepared, const std::vector<Index>& component) {
  const OrientedPoints& cloud = prepared.cloud;
  if (openness(cloud, component) > max_openness) return false;
  const std::optional<Gap> gap = find_gap(cloud, *prepared.tree, component);
  if (!gap) return false;
  const double spacing = std::max(mean_spacing(cloud, component), coarsest * gap->width);
  const auto spline = spline_across(cloud, *prepared.tree, component, *gap);
  const Added added = project(*spline, points_between(cloud, *gap, spacing), gap->width, convergence * spacing);
  if (added.points.cols() == 0) return false;
  add_spread(added, spacing, prepared);
  return true;
}

}  // namespace

Index bridge_gaps(PreparedCloud& prepared) {
  Index joined = 0;
  for (const std::vector<Index>& component : prepared.components) joined += join(prepared, component) ? 1 : 0;
  if (joined > 0)
    prepared.warnings.push_back(std::to_string(joined) + (joined == 1 ? " part" : " parts") +
                                " separated by gaps in the data: joined to the rest");
  return joined;
}

}  // namespace csrbf
