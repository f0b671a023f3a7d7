#include "csrbf/surface/prepare/volumes.hpp"

#include "csrbf/core/small_matrices.hpp"

namespace csrbf {
namespace {

// Chosen by hand: shares of the variance in the direction of least variance among 10 points.
constexpr double filling = 0.1;            // mean; on clean bodies of 100 points at most .07, in balls .09 to .15 ...
constexpr double on_sheet = 0.07;          // ... so below this they lie on a sheet
constexpr double on_line = 0.01;           // in the middle direction of all points: below this they are along a line
constexpr double compact = 0.06;           // of all points: thin rods and rings of few points have at most .05
constexpr double more_than_usual = 0.06;   // ... over that of the others
constexpr std::size_t most_others = 2000;  // where that is measured
// Mean cosine of the angle between chords and the sum of the normals at their ends: random ones have 2/3, those of
// solids at most .4. Chosen by hand.
constexpr double along_chords = 0.45;

// Shares of the variance in three directions, the least first: 0 on planes, 1/3 at most; the second is 0 on lines.
Eigen::Vector3d variance_shares(Points<3> points) {
  points.colwise() -= points.rowwise().mean().eval();
  const Eigen::Matrix3d covariance = points * points.transpose();
  return symmetric_eigen_direct(covariance).values.cwiseMax(0) /
         std::max(covariance.trace(), std::numeric_limits<double>::min());
}

double thickness_share(const Points<3>& points) {
  return variance_shares(points)[0];
}

// Mean over the neighbours of every step-th of the points.
double thickness_share_around(const Points<3>& points, const NeighborTable& near, const std::vector<Index>& ids,
                              std::size_t step) {
  double sum = 0;
  Index count = 0;
  for (std::size_t k = 0; k < ids.size(); k += step, ++count) {
    Points<3> around(3, near.k + 1);
    around.col(near.k) = points.col(ids[k]);
    for (Index j = 0; j < near.k; ++j) around.col(j) = points.col(near.of(ids[k])[j]);
    sum += thickness_share(around);
  }
  return sum / static_cast<double>(count);
}

// Whether the points have normals of one surface: on one that bends evenly, the chord to a neighbour is perpendicular
// to the sum of the normals at its ends.
bool follow_normals(const Points<3>& points, const Points<3>& normals, const NeighborTable& near,
                    const std::vector<Index>& ids) {
  if (normals.cols() == 0) return false;
  double sum = 0;
  for (const Index i : ids) {
    if (normals.col(i).isZero(0)) return false;
    for (const std::uint32_t j : near.of(i))
      sum += std::abs((points.col(j) - points.col(i)).normalized().dot(normals.col(i) + normals.col(j)));
  }
  return sum < along_chords * static_cast<double>(near.k * std::ssize(ids));
}

bool lie_in_layers(const Points<3>& points, const NeighborTable& near, const std::vector<Index>& ids, double thickest) {
  return variance_shares(points(Eigen::all, ids))[1] > on_line &&
         thickness_share_around(points, near, ids, 1) < thickest;
}

}  // namespace

bool lie_on_sheets(const Points<3>& points, const Points<3>& normals, const NeighborTable& near,
                   const std::vector<Index>& ids) {
  return lie_in_layers(points, near, ids, on_sheet) || follow_normals(points, normals, near, ids);
}

bool may_lie_on_sheets(const Points<3>& points, const Points<3>& normals, const NeighborTable& near,
                       const std::vector<Index>& ids) {
  return lie_in_layers(points, near, ids, filling) || follow_normals(points, normals, near, ids);
}

bool fill_volume(const Points<3>& points, const NeighborTable& near, const std::vector<Index>& ids,
                 const std::vector<Index>& others) {
  if (thickness_share(points(Eigen::all, ids)) < compact) return false;
  const double share = thickness_share_around(points, near, ids, 1);
  return share > filling &&
         share > more_than_usual + thickness_share_around(points, near, others, 1 + others.size() / most_others);
}

}  // namespace csrbf
