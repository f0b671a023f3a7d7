#include "csrbf/surface/prepare.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/surface/estimate_normals.hpp"
#include "csrbf/surface/orient_normals.hpp"

#include <Eigen/Eigenvalues>

#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <unordered_map>

namespace csrbf {
namespace {

constexpr Index neighbors = 10;          // for spacing: enough to average, few enough to stay local
constexpr double link_length = 4;        // in spacings: points closer than this belong to one cluster
constexpr double stray_sparseness = 3;   // a cluster is stray when its spacing is this many times the usual one
constexpr double stray_share = 0.005;    // ... and it holds fewer than this share of the points
constexpr double cloudy_share = 0.05;    // ... or fewer than this, and fills space instead of lying on a sheet:
constexpr double sheet_variation = 0.1;  // smallest share of the spread of neighbours in one direction (1/3 in a ball)
constexpr double usual_contradictions = 5e-4;     // share of neighbours whose given normals may disagree unexamined
constexpr double remaining_contradictions = 0.2;  // of them, when turning normals is the remedy

void warn(std::vector<std::string>& warnings, Index count, const std::string& text) {
  if (count > 0) warnings.push_back(std::to_string(count) + " " + text);
}

struct BitHash {
  std::size_t operator()(const std::array<double, 3>& p) const {
    std::uint64_t h = 0;
    for (const double c : p) h = (h ^ std::bit_cast<std::uint64_t>(c)) * 0x9E3779B97F4A7C15ULL + (h >> 29U);
    return static_cast<std::size_t>(h ^ (h >> 32U));
  }
};

// Indices of the finite points, the first of each group of equal ones; `normals` gets the sum of the group's normals.
std::vector<Index> distinct_points(const PointCloud& input, Points<3>& normals, std::vector<std::string>& warnings) {
  std::unordered_map<std::array<double, 3>, Index, BitHash> first;
  first.reserve(static_cast<std::size_t>(input.size()));
  std::vector<Index> kept;
  Index non_finite = 0;
  for (Index i = 0; i < input.size(); ++i) {
    if (!input.points.col(i).allFinite()) {
      ++non_finite;
      continue;
    }
    const std::array<double, 3> key = {input.points(0, i) + 0.0, input.points(1, i) + 0.0, input.points(2, i) + 0.0};
    const auto [entry, is_new] = first.emplace(key, i);
    if (is_new) {
      kept.push_back(i);
    } else if (normals.cols() > 0) {
      normals.col(entry->second) += normals.col(i);
    }
  }
  warn(warnings, non_finite, "points with NaN or infinite coordinates dropped");
  warn(warnings, input.size() - non_finite - static_cast<Index>(kept.size()), "duplicate points merged");
  return kept;
}

void require_spread(const Points<3>& y) {
  const Point<3> mean = y.rowwise().mean();
  const Eigen::Matrix3d covariance =
      (y.colwise() - mean) * (y.colwise() - mean).transpose() / static_cast<double>(y.cols());
  const Eigen::Vector3d spread = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues();
  if (!(spread[1] > 1e-14 * spread[2]))
    throw InvalidInput(
        "reconstruct: points: all lie on one line; a surface needs points that spread in at least two directions");
}

// Neighbour lists of all points: `k` entries each, the point itself first.
struct Neighborhoods {
  Index k = 0;
  std::vector<std::uint32_t> index;
  std::vector<float> distance2;
};

Neighborhoods find_neighbors(const Points<3>& points, Index k) {
  Neighborhoods result;
  result.k = std::min(k, points.cols());
  result.index.resize(static_cast<std::size_t>(points.cols() * result.k));
  result.distance2.resize(result.index.size());
  const KdTree<3> tree(points);
  parallel_for(points.cols(), 1024, [&](Index begin, Index end) {
    std::vector<Index> ids(static_cast<std::size_t>(result.k));
    std::vector<double> d2(ids.size());
    for (Index i = begin; i < end; ++i) {
      tree.nearest(points.col(i), result.k, ids.data(), d2.data());
      for (Index j = 0; j < result.k; ++j) {
        const auto to = static_cast<std::size_t>(i * result.k + j), from = static_cast<std::size_t>(j);
        result.index[to] = static_cast<std::uint32_t>(ids[from]);
        result.distance2[to] = static_cast<float>(d2[from]);
      }
    }
  });
  return result;
}

// Spacing s with s^2 = area per sample: the disc through the farthest neighbour, shared by the points on this sheet.
Eigen::VectorXd local_spacing(const Points<3>& normals, const Neighborhoods& near, Index n) {
  Eigen::VectorXd spacing(n);
  const double pi = 3.14159265358979323846;
  for (Index i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i * near.k);
    int same_sheet = 0;
    for (Index j = 0; j < near.k; ++j) {
      const Index other = near.index[row + static_cast<std::size_t>(j)];
      if (other != i && (normals.cols() == 0 || normals.col(i).dot(normals.col(other)) > 0)) ++same_sheet;
    }
    const double reach2 = near.distance2[row + static_cast<std::size_t>(near.k - 1)];
    spacing[i] = std::sqrt(pi * reach2 / std::max(1, same_sheet));
  }
  return spacing;
}

Index find_root(std::vector<Index>& parent, Index i) {
  while (parent[static_cast<std::size_t>(i)] != i) {
    parent[static_cast<std::size_t>(i)] = parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(i)])];
    i = parent[static_cast<std::size_t>(i)];
  }
  return i;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Whether j is among the neighbours of i. A stray point has neighbours on the surface, but is the neighbour of none of
// them.
bool is_neighbor(const Neighborhoods& near, Index i, Index j) {
  const auto first = near.index.begin() + i * near.k;
  return std::find(first, first + near.k, static_cast<std::uint32_t>(j)) != first + near.k;
}

// Share of the spread, in the direction of least spread, of the neighbours of point i in its own cluster; 1 when there
// are too few to tell.
double least_variation(const Points<3>& points, const Neighborhoods& near, std::vector<Index>& parent, Index i) {
  constexpr Index enough = 5;
  Points<3> together(3, near.k);
  Index count = 0;
  for (Index j = 0; j < near.k; ++j) {
    const Index other = near.index[static_cast<std::size_t>(i * near.k + j)];
    if (find_root(parent, other) == find_root(parent, i)) together.col(count++) = points.col(other);
  }
  if (count < enough) return 1;
  const Points<3> centered = together.leftCols(count).colwise() - together.leftCols(count).rowwise().mean();
  const Eigen::Matrix3d covariance = centered * centered.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0] / std::max(solver.eigenvalues().sum(), std::numeric_limits<double>::min());
}

// Marks the points to keep: clusters of points linked by short neighbour distances are stray when they are much sparser
// than usual and small, or fill space.
std::vector<char> keep_unless_stray(const Points<3>& points, const Neighborhoods& near) {
  const Index n = points.cols();
  std::vector<double> reach(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i)
    reach[static_cast<std::size_t>(i)] = std::sqrt(near.distance2[static_cast<std::size_t>(i * near.k + near.k / 2)]);
  const double usual = median(reach);
  std::vector<Index> parent(static_cast<std::size_t>(n));
  std::iota(parent.begin(), parent.end(), Index{0});
  for (Index i = 0; i < n; ++i)
    for (Index j = 1; j < near.k; ++j) {
      const auto entry = static_cast<std::size_t>(i * near.k + j);
      const Index other = near.index[entry];
      const double shorter = std::min(reach[static_cast<std::size_t>(i)], reach[static_cast<std::size_t>(other)]);
      if (near.distance2[entry] > link_length * link_length * shorter * shorter || !is_neighbor(near, other, i))
        continue;
      const Index a = find_root(parent, i), b = find_root(parent, other);
      parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  std::vector<Index> size(static_cast<std::size_t>(n), 0);
  std::vector<double> sum(static_cast<std::size_t>(n), 0);
  for (Index i = 0; i < n; ++i) {
    const auto root = static_cast<std::size_t>(find_root(parent, i));
    ++size[root];
    sum[root] += reach[static_cast<std::size_t>(i)];
  }
  std::vector<double> variation(static_cast<std::size_t>(n), 0);
  const auto is_sparse = [&](std::size_t root) {
    return static_cast<double>(size[root]) < cloudy_share * static_cast<double>(n) &&
           sum[root] > stray_sparseness * usual * static_cast<double>(size[root]);
  };
  for (Index i = 0; i < n; ++i) {
    const auto root = static_cast<std::size_t>(find_root(parent, i));
    if (is_sparse(root)) variation[root] += least_variation(points, near, parent, i) / static_cast<double>(size[root]);
  }
  std::vector<char> keep(static_cast<std::size_t>(n), 1);
  for (Index i = 0; i < n; ++i) {
    const auto root = static_cast<std::size_t>(find_root(parent, i));
    const bool small = static_cast<double>(size[root]) < stray_share * static_cast<double>(n);
    if (is_sparse(root) && (small || variation[root] > sheet_variation)) keep[static_cast<std::size_t>(i)] = 0;
  }
  return keep;
}

Points<3> select(const Points<3>& columns, const std::vector<Index>& ids) {
  Points<3> chosen(3, static_cast<Index>(ids.size()));
  for (std::size_t i = 0; i < ids.size(); ++i) chosen.col(static_cast<Index>(i)) = columns.col(ids[i]);
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

// Fills missing normals: estimated without orientation, turned to agree with the nearest given ones.
void fill_missing(const Points<3>& points, Points<3>& normals, const Progress& progress) {
  NormalOptions options;
  options.orient = Orient::none;
  options.progress = progress;
  const Points<3> estimated = estimate_normals(points, options);
  std::vector<Index> given;
  for (Index i = 0; i < normals.cols(); ++i)
    if (normals.col(i).squaredNorm() > 0) given.push_back(i);
  const Points<3> known = select(points, given);
  const KdTree<3> tree(known);
  for (Index i = 0; i < normals.cols(); ++i) {
    if (normals.col(i).squaredNorm() > 0) continue;
    Index nearest = 0;
    double d2 = 0;
    tree.nearest(points.col(i), 1, &nearest, &d2);
    const double side = estimated.col(i).dot(normals.col(given[static_cast<std::size_t>(nearest)]));
    normals.col(i) = side < 0 ? Point<3>(-estimated.col(i)) : Point<3>(estimated.col(i));
  }
}

// Share of the pairs of near neighbours whose normals point against each other.
double opposite_neighbors(const Points<3>& normals, const Neighborhoods& near) {
  Index pairs = 0, opposite = 0;
  for (Index i = 0; i < normals.cols(); ++i)
    for (Index j = 1; j < std::min<Index>(near.k, 5); ++j, ++pairs)
      if (normals.col(i).dot(normals.col(near.index[static_cast<std::size_t>(i * near.k + j)])) < 0) ++opposite;
  return pairs == 0 ? 0 : static_cast<double>(opposite) / static_cast<double>(pairs);
}

// Given normals with flipped patches disagree along the borders of the patches; then there is an orientation with far
// fewer disagreements. Noise or creases leave about as many however the normals are turned.
void reorient_if_better(PreparedCloud& result, const Neighborhoods& near, const Progress& progress) {
  OrientedPoints& cloud = result.cloud;
  if (opposite_neighbors(cloud.normals, near) < usual_contradictions) return;
  const double contradictions = 1 - orientation_consistency(cloud.points, cloud.normals);
  if (contradictions < usual_contradictions) return;
  Points<3> turned = cloud.normals;
  OrientOptions options;
  options.progress = progress;
  orient_normals(cloud.points, turned, options);
  if (1 - orientation_consistency(cloud.points, turned) > remaining_contradictions * contradictions) return;
  cloud.normals = std::move(turned);
  result.normals = "re-oriented";
  result.warnings.push_back("the given normals contradict each other: re-oriented");
}

void find_normals(PreparedCloud& result, const Neighborhoods& near, Normals source, bool given,
                  const Progress& progress) {
  OrientedPoints& cloud = result.cloud;
  NormalOptions options;
  options.progress = progress;
  if (source == Normals::estimate || !given) {
    cloud.normals = estimate_normals(cloud.points, options);
    result.normals = "estimated";
    return;
  }
  const Index missing = normalize(cloud.normals);
  if (2 * missing > cloud.size()) {
    result.warnings.push_back("most normals are zero: all estimated");
    cloud.normals = estimate_normals(cloud.points, options);
    result.normals = "estimated";
    return;
  }
  warn(result.warnings, missing, "missing normals estimated");
  if (missing > 0) fill_missing(cloud.points, cloud.normals, progress);
  result.normals = "file";
  if (source == Normals::automatic) reorient_if_better(result, near, progress);
}

}  // namespace

PreparedCloud prepare(const PointCloud& input, Normals source, const Progress& progress) {
  report(progress, "prepare", 0);
  require(input.normals.cols() == 0 || input.has_normals(), "reconstruct", "normals", input.normals.cols(),
          "must be as many as the points, or none");
  require(source != Normals::file || input.has_normals(), "reconstruct", "normals", "file",
          "the input has no normals; use estimate or auto");
  PreparedCloud result;
  Points<3> normals = input.normals;
  for (Index i = 0; i < normals.cols(); ++i)
    if (!normals.col(i).allFinite()) normals.col(i).setZero();
  std::vector<Index> kept = distinct_points(input, normals, result.warnings);
  require(kept.size() >= 4, "reconstruct", "points", kept.size(),
          "distinct finite points are too few; at least 4 are needed");

  // Unit coordinates, Morton order.
  Points<3> points = select(input.points, kept);
  const Box<3> box = bounding_box<3>(points);
  result.origin = box.lo + 0.5 * (box.hi - box.lo);
  result.scale = (box.hi - box.lo).stableNorm();
  for (Index i = 0; i < points.cols(); ++i) points.col(i) = (points.col(i) - result.origin) / result.scale;
  require_spread(points);
  const std::vector<Index> order = morton_order<3>(points);
  points = select(points, order);
  std::vector<Index> source_index(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) source_index[i] = kept[static_cast<std::size_t>(order[i])];
  report(progress, "prepare", 0.2);

  Neighborhoods near = find_neighbors(points, neighbors);
  report(progress, "prepare", 0.5);
  const std::vector<char> keep = keep_unless_stray(points, near);
  std::vector<Index> used;
  for (std::size_t i = 0; i < keep.size(); ++i)
    if (keep[i] != 0) used.push_back(static_cast<Index>(i));
  const Index stray = points.cols() - static_cast<Index>(used.size());
  if (stray > 0 && used.size() >= 4) {
    warn(result.warnings, stray, "stray points dropped");
    points = select(points, used);
    std::vector<Index> remaining;
    for (const Index i : used) remaining.push_back(source_index[static_cast<std::size_t>(i)]);
    source_index = std::move(remaining);
    near = find_neighbors(points, neighbors);
  }
  result.cloud.points = std::move(points);
  if (input.has_normals()) result.cloud.normals = select(normals, source_index);
  result.source = std::move(source_index);
  find_normals(result, near, source, input.has_normals(), progress);
  result.cloud.spacing = local_spacing(result.cloud.normals, near, result.cloud.size());
  for (const Index i : result.source) result.bounds.add(Point<3>(input.points.col(i)));
  report(progress, "prepare", 1);
  return result;
}

}  // namespace csrbf
