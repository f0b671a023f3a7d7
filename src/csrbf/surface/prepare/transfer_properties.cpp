#include "csrbf/surface/prepare/transfer_properties.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"

namespace csrbf {
namespace {

constexpr Index averaged_points = 4;  // averaged for a colour; chosen by hand: more blur, fewer show facets
constexpr Index grain = 1024;         // targets per task

bool is_color(const Property& p) {
  return p.type == "uchar" && (p.name == "red" || p.name == "green" || p.name == "blue" || p.name == "alpha");
}

// Finite samples in Morton order, with their index in the input.
struct Samples {
  Points<3> points{3, 0};
  std::vector<Index> source;
};

Samples sorted_samples(const PointsRef<3>& input) {
  std::vector<Index> finite;
  for (Index i = 0; i < input.cols(); ++i)
    if (input.col(i).allFinite()) finite.push_back(i);
  Samples samples;
  for (const Index i : morton_order<3>(input(Eigen::all, finite))) samples.source.push_back(finite[i]);
  samples.points = input(Eigen::all, samples.source);
  return samples;
}

struct Weights {
  std::array<Index, averaged_points> source{};
  std::array<double, averaged_points> weight{};
  Index count = 0;
};

// Inverse distances relative to the smallest one, so that they neither overflow nor depend on the unit of length; only
// coincident samples count at a target that coincides with some.
Weights weigh(const KdTree<3>& tree, const Samples& samples, const Point<3>& target) {
  Weights w;
  std::array<double, averaged_points> squared{};
  w.count = tree.nearest(target, averaged_points, w.source.data(), squared.data());
  double sum = 0;
  for (Index k = 0; k < w.count; ++k) {
    w.source[k] = samples.source[w.source[k]];
    w.weight[k] = squared[k] > squared[0] ? std::sqrt(squared[0] / squared[k]) : 1;
    sum += w.weight[k];
  }
  for (double& weight : w.weight) weight /= sum;
  return w;
}

double mean(const Property& p, const Weights& w) {
  double value = 0;
  for (Index k = 0; k < w.count; ++k) value += w.weight[k] * p.values[w.source[k]];
  return std::round(value);
}

}  // namespace

std::vector<Property> transfer_properties(const PointsRef<3>& samples, const std::vector<Property>& properties,
                                          const PointsRef<3>& targets) {
  std::vector<Property> result;
  for (const Property& p : properties) {
    require(p.values.size() == samples.cols(), "transfer_properties", "size of property " + p.name, p.values.size(),
            "one value per sample is needed");
    result.push_back({p.name, p.type, Eigen::VectorXd(targets.cols())});
  }
  if (result.empty() || targets.cols() == 0) return result;

  const Samples sorted = sorted_samples(samples);
  require(sorted.points.cols() > 0, "transfer_properties", "finite samples", 0, "at least one is needed");
  const KdTree<3> tree(sorted.points);
  parallel_for(targets.cols(), grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Weights w = weigh(tree, sorted, targets.col(i));
      for (std::size_t p = 0; p < result.size(); ++p)
        result[p].values[i] = is_color(properties[p]) ? mean(properties[p], w) : properties[p].values[w.source[0]];
    }
  });
  return result;
}

}  // namespace csrbf
