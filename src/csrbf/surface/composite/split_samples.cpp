#include "csrbf/surface/composite/split_samples.hpp"

#include <limits>
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

// Disjoint sets whose members know the number of their set: most pairs of samples are of one set already.
class Labels {
 public:
  explicit Labels(std::uint32_t n) : label_(n), next_(n), size_(n, 1) {
    std::iota(label_.begin(), label_.end(), 0U);
    std::iota(next_.begin(), next_.end(), 0U);
  }
  [[nodiscard]] std::uint32_t of(std::uint32_t i) const { return label_[i]; }

  // Of two different sets, the smaller one is given the number of the larger one.
  void unite(std::uint32_t a, std::uint32_t b) {
    if (size_[label_[a]] < size_[label_[b]]) std::swap(a, b);
    size_[label_[a]] += size_[label_[b]];
    std::uint32_t i = b;
    do label_[i] = label_[a];
    while ((i = next_[i]) != b);
    std::swap(next_[a], next_[b]);
  }

 private:
  std::vector<std::uint32_t> label_, next_, size_;  // next_: a ring through each set
};

// In the order of their first members.
std::vector<std::vector<Index>> groups_of(const Labels& labels, std::span<const Index> ids) {
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::vector<std::vector<Index>> groups;
  std::vector<std::size_t> group_of(ids.size(), none);  // by label
  for (std::uint32_t a = 0; a < ids.size(); ++a) {
    std::size_t& group = group_of[labels.of(a)];
    if (group == none) {
      group = groups.size();
      groups.emplace_back();
    }
    groups[group].push_back(ids[a]);
  }
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
    std::uint32_t id;
    bool compatible;
  };
  std::vector<Sample> samples;
  samples.reserve(n);
  for (const std::uint32_t a : sorted)
    samples.push_back({points.col(a), reach[a], a, normals.col(a).dot(normal) > compatible_normals});
  Labels labels(n);
  std::uint32_t end = 0;
  for (std::uint32_t s = 0; s < n; ++s) {
    while (end < n && samples[end].point[0] - samples[s].point[0] <= longest) ++end;
    for (std::uint32_t t = s + 1; t < end; ++t) {
      const Sample &first = samples[s], &second = samples[t];
      const std::uint32_t a = first.id, b = second.id;
      if (labels.of(a) == labels.of(b)) continue;
      const Point<3> step = second.point - first.point;
      const double length = std::max(first.reach, second.reach);
      if (first.compatible != second.compatible || step.squaredNorm() > length * length) continue;
      if (continues(step, normals.col(a), normals.col(b), link_height / link_length * length)) labels.unite(a, b);
    }
  }
  std::vector<std::vector<Index>> groups = groups_of(labels, ids);
  // Groups beside each other on one surface, as between the lines of a scanner.
  std::vector<Mean> means;
  for (const std::vector<Index>& group : groups) means.push_back(mean_of(cloud, group));
  const auto is_compatible = [&](const std::vector<Index>& group) {
    return cloud.normals.col(group[0]).dot(normal) > compatible_normals;
  };
  for (std::size_t a = 0; a < groups.size(); ++a)
    for (std::size_t b = a + 1; b < groups.size();) {
      if (is_compatible(groups[a]) != is_compatible(groups[b]) ||
          !continues(means[b].point - means[a].point, means[a].normal, means[b].normal, 0)) {
        ++b;
        continue;
      }
      groups[a].insert(groups[a].end(), groups[b].begin(), groups[b].end());
      means[a] = mean_of(cloud, groups[a]);
      groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(b));
      means.erase(means.begin() + static_cast<std::ptrdiff_t>(b));
      b = a + 1;
    }
  std::erase_if(groups, [&](const auto& group) { return static_cast<Index>(group.size()) < least; });
  return groups;
}

}  // namespace csrbf
