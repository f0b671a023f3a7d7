#include "csrbf/surface/composite/split_samples.hpp"

#include "csrbf/core/disjoint_sets.hpp"

#include <numeric>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double link_length = 2.5;    // spacings between samples that are linked: about three rings of neighbours
constexpr double link_normals = 0.87;  // least cosine between their normals: 30 degrees
constexpr double link_slope = 0.5;     // sine of the largest angle of the link with the surface ...
constexpr double link_height = 0.2;    // ... or its height above the surface in spacings, for noise

// Whether b continues a, as far as two samples tell.
bool continues(const Point<3>& step, const Point<3>& normal_a, const Point<3>& normal_b, double height) {
  const double cosine = normal_a.dot(normal_b);
  if (cosine < link_normals) return false;
  const double rise = step.dot(normal_a + normal_b),
               largest = std::max(link_slope * link_slope * step.squaredNorm(), height * height);
  return rise * rise <= (2 + 2 * cosine) * largest;
}

// Mean position and normal of a group.
struct Mean {
  Point<3> point = Point<3>::Zero(), normal = Point<3>::Zero();
};

Mean mean_of(const OrientedPoints& cloud, const std::vector<Index>& group) {
  Mean mean;
  for (const Index i : group) {
    mean.point += cloud.points.col(i) / static_cast<double>(group.size());
    mean.normal += cloud.normals.col(i);
  }
  mean.normal.normalize();
  return mean;
}

std::vector<std::vector<Index>> groups_of(DisjointSets& sets, std::span<const Index> ids) {
  std::vector<std::vector<Index>> groups(ids.size());
  for (std::size_t a = 0; a < ids.size(); ++a) groups[sets.find(static_cast<std::uint32_t>(a))].push_back(ids[a]);
  std::erase_if(groups, [](const auto& group) { return group.empty(); });
  return groups;
}

}  // namespace

std::vector<std::vector<Index>> split_samples(const OrientedPoints& cloud, std::span<const Index> ids,
                                              const Point<3>& normal, double stretch, Index least) {
  const auto n = static_cast<std::uint32_t>(ids.size());
  const std::vector<Index> chosen(ids.begin(), ids.end());
  const Points<3> points = cloud.points(Eigen::all, chosen), normals = cloud.normals(Eigen::all, chosen);
  const Eigen::VectorXd reach = link_length * stretch * cloud.spacing(chosen);
  const double longest = reach.maxCoeff();
  std::vector<std::uint32_t> sorted(n);  // by x, so that only few pairs are looked at
  std::iota(sorted.begin(), sorted.end(), 0U);
  std::sort(sorted.begin(), sorted.end(), [&](auto a, auto b) { return points(0, a) < points(0, b); });
  struct Sample {
    Point<3> point;
    double reach;
    bool compatible;
  };
  std::vector<Sample> samples;
  samples.reserve(n);
  for (const std::uint32_t a : sorted)
    samples.push_back({points.col(a), reach[a], normals.col(a).dot(normal) > compatible_normals});
  DisjointSets sets(n);
  for (std::uint32_t s = 0; s < n; ++s)
    for (std::uint32_t t = s + 1; t < n; ++t) {
      const Sample &first = samples[s], &second = samples[t];
      const Point<3> step = second.point - first.point;
      if (step[0] > longest) break;
      const double length = std::max(first.reach, second.reach);
      if (first.compatible != second.compatible || step.squaredNorm() > length * length) continue;
      const std::uint32_t a = sorted[s], b = sorted[t];
      if (sets.find(a) == sets.find(b)) continue;
      if (continues(step, normals.col(a), normals.col(b), link_height / link_length * length)) sets.unite(a, b);
    }
  std::vector<std::vector<Index>> groups = groups_of(sets, ids);
  // Groups beside each other on one surface, as between the lines of a scanner.
  for (std::size_t a = 0; a < groups.size(); ++a)
    for (std::size_t b = a + 1; b < groups.size();) {
      const Mean first = mean_of(cloud, groups[a]), second = mean_of(cloud, groups[b]);
      const bool same_side = (cloud.normals.col(groups[a][0]).dot(normal) > compatible_normals) ==
                             (cloud.normals.col(groups[b][0]).dot(normal) > compatible_normals);
      if (!same_side || !continues(second.point - first.point, first.normal, second.normal, 0)) {
        ++b;
        continue;
      }
      groups[a].insert(groups[a].end(), groups[b].begin(), groups[b].end());
      groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(b));
      b = a + 1;
    }
  std::erase_if(groups, [&](const auto& group) { return static_cast<Index>(group.size()) < least; });
  return groups;
}

}  // namespace csrbf
