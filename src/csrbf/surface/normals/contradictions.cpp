#include "csrbf/surface/normals/contradictions.hpp"

#include "csrbf/core/percentile.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index most_measured = 5000;  // points whose neighbours show what is usual
constexpr double usual_share = 0.75;   // of the pairs that agree
constexpr double higher = 2;           // times as high as is usual: another sheet
constexpr double least_rise = 0.2;     // sum of two sines that is not high, 6 degrees each ...
constexpr double most_rise = 1;        // ... and that always is: 30 degrees
constexpr std::size_t nearest = 4;     // neighbours that are compared

}  // namespace

Contradictions::Contradictions(const Points<3>& points, const Points<3>& normals, const NeighborTable& near)
    : points_(points), near_(near) {
  const Index step = std::max<Index>(1, near.size() / most_measured);
  std::vector<double> rises;
  for (Index i = 0; i < near.size(); i += step)
    for (const std::uint32_t j : near.of(i))
      if (normals.col(i).dot(normals.col(j)) > same_side) rises.push_back(rise(normals, i, j));
  if (!rises.empty()) largest_rise_ = std::clamp(higher * percentile(rises, usual_share), least_rise, most_rise);
}

// Sum of the sines of the angles between the way from i to j and the tangent planes of both.
double Contradictions::rise(const Points<3>& normals, Index i, Index j) const {
  const Point<3> step = points_.col(j) - points_.col(i);
  const double length = step.norm();
  return length > 0 ? (std::abs(step.dot(normals.col(i))) + std::abs(step.dot(normals.col(j)))) / length : 0;
}

bool Contradictions::between(const Points<3>& normals, Index i, Index j) const {
  return normals.col(i).dot(normals.col(j)) < -same_side && rise(normals, i, j) < largest_rise_;
}

double Contradictions::share(const Points<3>& normals) const {
  Index pairs = 0, opposite = 0;
  for (Index i = 0; i < near_.size(); ++i)
    for (const std::uint32_t j : near_.of(i).first(std::min(nearest, static_cast<std::size_t>(near_.k)))) {
      ++pairs;
      if (between(normals, i, j)) ++opposite;
    }
  return pairs == 0 ? 0 : static_cast<double>(opposite) / static_cast<double>(pairs);
}

}  // namespace csrbf
