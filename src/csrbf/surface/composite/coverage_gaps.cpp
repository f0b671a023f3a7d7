#include "csrbf/surface/composite/coverage_gaps.hpp"

#include "csrbf/core/parallel.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double reach_factor = 0.6;   // search radius over patch radius; larger: smoother, smaller: fewer samples
constexpr double extension = 1.4;      // factor on that radius for a second search if no sample lies beyond the gap
constexpr double same_sheet = 0.5;     // cosine between normals: samples within 60 degrees are on one sheet
constexpr double least_weight = 0.05;  // sum of weights, just above the 0.04 of trusted_weight in composite_field.cpp
constexpr Index gap_patches_per_task = 64;  // large enough to hide the cost of a task

constexpr double r = 0.7071067811865476;
constexpr double directions[8][2] = {{1, 0}, {r, r}, {0, 1}, {-r, r}, {-1, 0}, {-r, -r}, {0, -1}, {r, -r}};

}  // namespace

std::vector<CoverageGap> find_coverage_gaps(const Patches& patches) {
  const Index tasks = (patches.pieces() + gap_patches_per_task - 1) / gap_patches_per_task;
  std::vector<std::vector<CoverageGap>> found(tasks);
  const auto compute = [&](Index begin, Index end) {
    std::vector<CoverageGap>& gaps = found[begin / gap_patches_per_task];
    double W[std::size(directions)];
    Points<3> probes(3, std::size(directions));
    for (Index i = begin; i < end; ++i) {
      const Patch& patch = patches.patch(i);
      if (patch.join != Join::first) continue;
      const Eigen::Matrix3d axes = patch.radius * patch.T.transpose();
      const auto onward = [&](Index d) -> Point<3> {
        return directions[d][0] * axes.col(0) + directions[d][1] * axes.col(1);
      };
      for (Index d = 0; d < probes.cols(); ++d) probes.col(d) = patch.center + patch.radius * onward(d);
      patches.weights(probes, W, least_weight);
      for (Index d = 0; d < probes.cols(); ++d)
        if (W[d] < least_weight) gaps.push_back({probes.col(d), axes.col(2), onward(d), reach_factor * patch.radius});
    }
  };
  parallel_for(patches.pieces(), gap_patches_per_task, compute);
  std::vector<CoverageGap> all;
  for (const std::vector<CoverageGap>& gaps : found) all.insert(all.end(), gaps.begin(), gaps.end());
  return all;
}

void samples_around(const OrientedPoints& cloud, const KdTree<3>& tree, const CoverageGap& gap,
                    std::vector<Index>& ids) {
  const auto foreign = [&](Index i) { return cloud.normals.col(i).dot(gap.normal) < same_sheet; };
  const auto beyond = [&](Index i) { return (cloud.points.col(i) - gap.middle).dot(gap.onward) > 0; };
  for (const double reach : {gap.reach, extension * gap.reach}) {
    tree.within(gap.middle, reach, ids);
    std::erase_if(ids, foreign);
    if (std::any_of(ids.begin(), ids.end(), beyond)) return;
  }
  ids.clear();
}

}  // namespace csrbf
