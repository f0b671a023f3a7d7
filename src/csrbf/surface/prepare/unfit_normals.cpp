#include "csrbf/surface/prepare/unfit_normals.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"

#include <array>
#include <map>
#include <optional>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index most_asked = 4096;     // samples looked at, evenly spaced
constexpr Index fewest_judged = 32;    // samples with clear planes that decide
constexpr double shared_share = 0.02;  // of the samples: normals of fewer are not taken for equal ones
constexpr double rounding = 1e-5;      // normals that differ by less are equal
constexpr double thin = 0.05;          // variance across a clear plane over the smaller one within
constexpr double wide = 0.2;           // smaller variance within a clear plane over the larger one
constexpr double agreeing = 0.7;       // least cosine of the angle between a normal and its plane: about 45 degrees
constexpr double contradicting_share = 0.2;  // of clear planes that may contradict normals that fit
constexpr double off_plane = 0.25;           // median sine of the slopes between samples that share one but no plane
constexpr double clear_share = 0.1;          // of the samples that have to have a clear plane then

using Key = std::array<int, 3>;

Key key_of(const Point<3>& n) {
  Key key;
  for (int c = 0; c < 3; ++c) key[static_cast<std::size_t>(c)] = static_cast<int>(std::lround(n[c] / rounding));
  return key;
}

// Normal of the plane through a sample and its nearest ones, if these determine one clearly.
std::optional<Point<3>> plane_normal(const Points<3>& points, const NeighborTable& near, Index i) {
  Point<3> mean = points.col(i);
  for (const std::uint32_t j : near.of(i)) mean += points.col(j);
  mean /= static_cast<double>(near.k + 1);
  Eigen::Matrix3d scatter = (points.col(i) - mean) * (points.col(i) - mean).transpose();
  for (const std::uint32_t j : near.of(i)) scatter += (points.col(j) - mean) * (points.col(j) - mean).transpose();
  const SymmetricEigen axes = symmetric_eigen_direct(scatter);
  if (!(axes.values[0] < thin * axes.values[1] && axes.values[1] > wide * axes.values[2])) return std::nullopt;
  return Point<3>(axes.vectors.col(0));
}

// Mean of the normals of a sample and its neighbours, up to sign: errors of single ones do not count.
Point<3> mean_normal(const NeighborTable& near, const Points<3>& normals, Index i) {
  const Point<3> n = normals.col(i);
  Point<3> sum = n;
  for (const std::uint32_t j : near.of(i))
    sum += normals.col(j).dot(n) < 0 ? Point<3>(-normals.col(j)) : normals.col(j);
  return sum.normalized();
}

// Samples that were asked.
struct Asked {
  Index count = 0, clear = 0, contradicting = 0;
  std::vector<double> slopes;  // sines to the planes of contradicting ones of the lines to neighbours that share theirs

  // Whether the plane of sample i contradicts a normal n.
  bool ask(const Points<3>& points, const NeighborTable& near, Index i, const Point<3>& n) {
    ++count;
    const std::optional<Point<3>> plane = plane_normal(points, near, i);
    if (!plane) return false;
    ++clear;
    const bool contradicts = std::abs(plane->dot(n)) < agreeing;
    contradicting += contradicts ? 1 : 0;
    return contradicts;
  }
  void ask_shared(const Points<3>& points, const NeighborTable& near, const Points<3>& normals, Index i) {
    const Point<3> n = normals.col(i);
    if (!ask(points, near, i, n)) return;
    for (const std::uint32_t j : near.of(i))
      if ((normals.col(j) - n).squaredNorm() < rounding * rounding)
        slopes.push_back(std::abs((points.col(j) - points.col(i)).normalized().dot(n)));
  }

  [[nodiscard]] bool contradict() const {
    return clear >= fewest_judged &&
           static_cast<double>(contradicting) > contradicting_share * static_cast<double>(clear);
  }
  // Faces narrower than the distance of samples have planes that contradict their normals too, but are planes.
  [[nodiscard]] bool are_unset() const {
    return contradict() && !slopes.empty() && median(std::vector(slopes)) > off_plane;
  }
};

}  // namespace

UnfitNormals clear_unfit_normals(const Points<3>& points, const NeighborTable& near, Points<3>& normals) {
  UnfitNormals result;
  if (near.k < 3) return result;
  std::vector<Index> asked;
  for (Index i = 0; i < points.cols(); i += std::max<Index>(1, points.cols() / most_asked))
    if (normals.col(i).squaredNorm() > 0) asked.push_back(i);
  std::map<Key, std::vector<Index>> equal;
  for (const Index i : asked) equal[key_of(normals.col(i))].push_back(i);
  Index most = 0, groups = 0;
  for (auto& [key, ids] : equal) {
    std::erase_if(ids, [&](Index i) { return normals.col(i).isZero(0); });  // equal to those of a group before, too
    if (static_cast<double>(ids.size()) < shared_share * static_cast<double>(asked.size())) continue;
    Asked group;
    for (const Index i : ids) group.ask_shared(points, near, normals, i);
    if (!group.are_unset()) continue;
    const Point<3> value = normals.col(ids.front());
    Index cleared = 0;
    for (Index i = 0; i < points.cols(); ++i) {
      if (!((normals.col(i) - value).squaredNorm() < rounding * rounding)) continue;
      normals.col(i).setZero();
      ++cleared;
    }
    result.unset += cleared;
    ++groups;
    if (cleared > most) result.value = value;
    most = std::max(most, cleared);
  }
  Asked others;
  for (const Index i : asked)
    if (normals.col(i).squaredNorm() > 0) others.ask(points, near, i, mean_normal(near, normals, i));
  const bool clear = static_cast<double>(others.clear) > clear_share * static_cast<double>(others.count);
  result.all = groups > 1 || (clear && others.contradict());  // for unknown normals, programs write one value only
  return result;
}

}  // namespace csrbf
