#include "csrbf/surface/surface_distances.hpp"

#include "csrbf/core/shared_evaluate.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

constexpr double smallest_slope = 0.1;  // of f near the surface, where it is about 1

}  // namespace

std::vector<double> surface_distances(const Field<3>& field, const PointsRef<3>& points, double diagonal) {
  const Jet<3> jet = shared_evaluate(field, points, Derivatives::gradient);
  std::vector<double> distance(static_cast<std::size_t>(points.cols()));
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const auto column = static_cast<Index>(i);
    distance[i] = std::abs(jet.value[column]) / std::max(jet.gradient.col(column).norm(), smallest_slope) / diagonal;
  }
  return distance;
}

void summarize_distances(std::vector<double> distance, ReconstructReport& report) {
  double sum = 0;
  for (const double d : distance) sum += d * d;
  report.rms_distance = std::sqrt(sum / static_cast<double>(distance.size()));
  report.max_distance = *std::max_element(distance.begin(), distance.end());
  const auto p99 = distance.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(distance.size() - 1));
  std::nth_element(distance.begin(), p99, distance.end());
  report.p99_distance = *p99;
}

}  // namespace csrbf
