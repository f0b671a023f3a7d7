#include "csrbf/surface/normals/contradictions.hpp"

#include "csrbf/core/parallel.hpp"
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
constexpr Index fewest_of_side = 2;    // neighbours that agree, and that contradict, on a seam ...
constexpr double apart = 0.5;          // ... whose means are so far apart, in distances of the farthest of them
constexpr double long_seams = 0.3;     // points on seams by the root of the number of all: about so many has a seam
                                       // of a twelfth of the side of a square sheet
constexpr double hardly_there = 0.1;   // of them with other normals
constexpr double of_sheets = 0.2;      // least difference of the shares of pairs above and below, of all pairs

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

// Beside a crease, the normals on one side of a surface are mirror images in the plane between their points.
bool Contradictions::across_crease(const Points<3>& normals, Index i, Index j) const {
  const Point<3> step = points_.col(j) - points_.col(i), n = normals.col(i), other = normals.col(j);
  const double cosine = n.dot(other), squared = step.squaredNorm();
  return std::abs(cosine) <= same_side && squared > 0 &&
         cosine - 2 * n.dot(step) * other.dot(step) / squared < -same_side;
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

bool Contradictions::on_seam(const Points<3>& normals, Index i, bool creases) const {
  Point<3> agree = Point<3>::Zero(), oppose = agree;  // sums of steps along the tangent plane
  Index agreeing = 0, opposing = 0;
  double farthest = 0;
  const Point<3> n = normals.col(i);
  for (const std::uint32_t j : near_.of(i)) {
    const bool agrees = n.dot(normals.col(j)) > same_side;
    if (!agrees && !between(normals, i, j) && !(creases && across_crease(normals, i, j))) continue;
    const Point<3> to = points_.col(j) - points_.col(i), along = to - to.dot(n) * n;
    farthest = std::max(farthest, along.norm());
    (agrees ? agree : oppose) += along;
    ++(agrees ? agreeing : opposing);
  }
  if (agreeing < fewest_of_side || opposing < fewest_of_side) return false;
  const Point<3> difference = agree / static_cast<double>(agreeing) - oppose / static_cast<double>(opposing);
  return difference.norm() > apart * farthest;
}

Index Contradictions::count_seams(const Points<3>& normals, bool creases) const {
  std::vector<char> found(near_.size(), 0);
  parallel_for(near_.size(), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) found[i] = on_seam(normals, i, creases) ? 1 : 0;
  });
  return std::count(found.begin(), found.end(), 1);
}

Index Contradictions::on_seams(const Points<3>& normals) const {
  return count_seams(normals, false);
}

Index Contradictions::on_seams_and_creases(const Points<3>& normals) const {
  return count_seams(normals, true);
}

bool Contradictions::are_of_sheets(const Points<3>& normals) const {
  Index above = 0, opposite = 0;
  for (Index i = 0; i < near_.size(); ++i)
    for (const std::uint32_t j : near_.of(i)) {
      if (!(normals.col(i).dot(normals.col(j)) < -same_side)) continue;
      ++opposite;
      above += (points_.col(i) - points_.col(j)).dot(normals.col(i) - normals.col(j)) > 0 ? 1 : 0;
    }
  return std::abs(2 * static_cast<double>(above) - static_cast<double>(opposite)) >
         of_sheets * static_cast<double>(opposite);
}

bool cuts_sheet(const Points<3>& points, const NeighborTable& near, const Points<3>& normals, const Points<3>& others) {
  const Contradictions present(points, normals, near), other(points, others, near);
  const auto longer = [&](auto seams) {
    const auto length = static_cast<double>((present.*seams)(normals));
    return length > long_seams * std::sqrt(static_cast<double>(near.size())) &&
           static_cast<double>((other.*seams)(others)) < hardly_there * length;
  };
  return longer(&Contradictions::on_seams) || longer(&Contradictions::on_seams_and_creases);
}

}  // namespace csrbf
