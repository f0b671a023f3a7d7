#include "csrbf/surface/normals/inward_parts.hpp"

#include "csrbf/surface/winding/winding_sum.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index most_samples = 100'000;  // of the cloud, evenly chosen: bounds time, a mean needs no more
constexpr Index most_probes = 200;       // points of each part over which the winding number is averaged
constexpr double inward = -0.4;          // largest mean winding number of an inward part: -1/2 plus noise and holes

// Every stride-th sample, with the area of `stride` samples, smoothed over so many spacings.
winding::Tree make_tree(const OrientedPoints& cloud, double smoothing) {
  const Index stride = 1 + (cloud.size() - 1) / most_samples;
  const auto some = Eigen::seq(0, cloud.size() - 1, stride);
  const Points<3> points = cloud.points(Eigen::all, some), normals = cloud.normals(Eigen::all, some);
  const Eigen::VectorXd areas = static_cast<double>(stride) * cloud.spacing(some).cwiseAbs2();
  return winding::make_tree({points, normals, areas, smoothing * areas.cwiseSqrt()});
}

std::vector<Index> samples_of_no(const std::vector<std::vector<Index>>& components, Index size) {
  std::vector<char> on_component(size, 0);
  for (const std::vector<Index>& component : components)
    for (const Index i : component) on_component[i] = 1;
  std::vector<Index> result;
  for (Index i = 0; i < size; ++i)
    if (on_component[i] == 0) result.push_back(i);
  return result;
}

}  // namespace

std::vector<bool> inward_parts(const OrientedPoints& cloud, const std::vector<std::vector<Index>>& components) {
  const winding::Tree smooth = make_tree(cloud, 1), sharp = make_tree(cloud, 0.5);
  const auto is_inward = [&](const std::vector<Index>& part) {
    const Index size = std::ssize(part), count = std::min(size, most_probes);
    Points<3> probes(3, count);
    for (Index k = 0; k < count; ++k) probes.col(k) = cloud.points.col(part[k * size / count]);
    // On thin parts, smoothing takes some of the winding number away, in proportion to its length.
    return count > 0 && 2 * winding::sum_at(sharp, probes).mean() - winding::sum_at(smooth, probes).mean() < inward;
  };
  std::vector<bool> result;
  for (const std::vector<Index>& component : components) result.push_back(is_inward(component));
  result.push_back(is_inward(samples_of_no(components, cloud.size())));
  return result;
}

}  // namespace csrbf
