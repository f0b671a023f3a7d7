#include "csrbf/approx/unity/patch_samples.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace csrbf {
namespace {

// All chosen by hand. Shares of the variance of a filled ball:
constexpr double even_spread = 0.35;  // smallest variance from which samples count as evenly spread
constexpr double flat = 1e-10;        // smallest variance below which they are on a line or plane, up to rounding

constexpr Index most_spread = 400;          // samples; larger patches extend far enough in any case
constexpr Index widening = 4, widest = 16;  // where they are lopsided, this many times more samples are considered
constexpr double least_variance = 1e-2;     // over the largest one: bounds the condition of a metric
constexpr double reach_share = 0.45;        // estimate of the ball of a cell's points, in diagonals of the cell
constexpr Index telling = 16;               // points that tell how dense they are about a cell ...
constexpr double largest_cell = 100;        // ... and its diagonal in their distances, from which on it is a void

// Keeps the n / 2 nearest samples, and of the others those that are farthest from all kept before.
template <int Dim>
void spread(const Points<Dim>& points, Index n, std::vector<std::pair<double, std::uint32_t>>& found) {
  const Index near = n / 2, count = std::ssize(found);
  Points<Dim> places(Dim, count);
  for (Index i = 0; i < count; ++i) places.col(i) = points.col(found[static_cast<std::size_t>(i)].second);
  Eigen::ArrayXd distance = Eigen::ArrayXd::Constant(count, std::numeric_limits<double>::infinity()), to_kept(count);
  const auto keep = [&](Index k) {
    const Index rest = count - k - 1;
    const Point<Dim> kept = places.col(k);
    squared_distances<Dim>(places.data() + Dim * (k + 1), rest, kept, to_kept.data());
    distance.tail(rest) = distance.tail(rest).min(to_kept.head(rest));
  };
  for (Index k = 0; k < near; ++k) keep(k);
  for (Index k = near; k < n; ++k) {
    const double* farthest = std::max_element(distance.data() + k, distance.data() + count);
    const Index at = farthest - distance.data();
    std::swap(found[static_cast<std::size_t>(k)], found[static_cast<std::size_t>(at)]);
    places.col(k).swap(places.col(at));
    std::swap(distance[k], distance[at]);
    keep(k);
  }
  found.resize(static_cast<std::size_t>(n));
  std::sort(found.begin(), found.end());
}

// Whether the smallest variance is below a share of that of a filled ball.
template <int Dim>
bool narrower(double share, const Points<Dim>& points, const std::vector<std::pair<double, std::uint32_t>>& chosen) {
  const auto n = static_cast<double>(chosen.size());
  Point<Dim> mean = Point<Dim>::Zero();
  double reach2 = 0;
  for (const auto& [d2, id] : chosen) {
    mean += points.col(id) / n;
    reach2 = std::max(reach2, d2);
  }
  Eigen::Matrix<double, Dim, Dim> covariance = Eigen::Matrix<double, Dim, Dim>::Zero();
  for (const auto& [d2, id] : chosen) covariance += (points.col(id) - mean) * (points.col(id) - mean).transpose() / n;
  covariance.diagonal().array() -= share * reach2 / (Dim + 2);
  return !positive_definite(covariance);
}

// See find_patch_samples.
template <int Dim>
Eigen::Matrix<double, Dim, Dim> metric_of(const Points<Dim>& points, const Point<Dim>& center, double anisotropy,
                                          const std::vector<std::pair<double, std::uint32_t>>& nearest) {
  using Matrix = Eigen::Matrix<double, Dim, Dim>;
  const double reach2 = nearest.back().first;
  if (!(anisotropy > 0 && reach2 > 0)) return Matrix::Identity();
  Matrix covariance = Matrix::Zero();
  for (const auto& [d2, id] : nearest)
    covariance += (points.col(id) - center) * (points.col(id) - center).transpose() / reach2;
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  const Matrix axes = eigen.vectors;
  const Point<Dim> variances = eigen.values.cwiseMax(least_variance * eigen.values[Dim - 1]);
  const Point<Dim> scales = variances.array().pow(-0.5 * anisotropy);
  return axes * scales.asDiagonal() * axes.transpose();
}

// Whether a cell is much larger than the distances of the points around it.
template <int Dim>
bool is_void(const Cover<Dim>& cover, Index cell) {
  const Box<Dim>& box = cover.cell(cell);
  const Points<Dim>& points = cover.points();
  typename Cover<Dim>::Search search;
  cover.nearest(box.center(), std::min(telling, points.cols()), box.diagonal(), search);
  std::vector<double> nearest2;
  for (const auto& [own2, id] : search.found) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [other2, other] : search.found)
      if (other != id) least = std::min(least, (points.col(other) - points.col(id)).squaredNorm());
    nearest2.push_back(least);
  }
  return box.diagonal() > largest_cell * std::sqrt(median(nearest2));
}

template <int Dim>
bool voids_are_rare(const Cover<Dim>& cover) {
  constexpr Index asked = 50, few = 5;  // cells
  const Index count = std::min(asked, cover.size());
  Index found = 0;
  for (Index k = 0; k < count; ++k) found += is_void(cover, (2 * k + 1) * cover.size() / (2 * count)) ? 1 : 0;
  return found * asked <= few * count;
}

// Systematic sampling of cells in proportion to their weight.
std::vector<Index> cells_by_weight(const Eigen::VectorXd& weight, Index wanted) {
  std::vector<Index> cells;
  const double total = weight.sum();
  double reached = 0;
  Index next = 0;
  for (Index c = 0; c < weight.size() && next < wanted; ++c) {
    reached += weight[c];
    const auto place = [&] { return total * (static_cast<double>(next) + 0.5) / static_cast<double>(wanted); };
    if (reached < place()) continue;
    cells.push_back(c);
    while (next < wanted && reached >= place()) ++next;
  }
  return cells;
}

}  // namespace

template <int Dim>
bool lopsided(const Points<Dim>& points, const std::vector<std::pair<double, std::uint32_t>>& chosen) {
  return narrower<Dim>(even_spread, points, chosen);
}

template <int Dim>
SpreadCells spread_cells(const Cover<Dim>& cover, Index count) {
  const bool without_voids = voids_are_rare(cover);
  Eigen::VectorXd volumes(cover.size()), counts(cover.size());
  for (Index c = 0; c < cover.size(); ++c) {
    volumes[c] = cover.cell(c).extent().prod();
    counts[c] = static_cast<double>(cover.count(c));
  }
  for (bool changed = without_voids; changed;) {  // those that would be most of the volume
    changed = false;
    const double large = 2 * volumes.sum() / static_cast<double>(count);
    for (Index c = 0; c < cover.size(); ++c) {
      if (!(volumes[c] > large && is_void(cover, c))) continue;
      volumes[c] = 0;
      changed = true;
    }
  }
  SpreadCells result;
  const auto add = [&](const Eigen::VectorXd& weights) {
    for (const Index c : cells_by_weight(weights, std::min(count / 2, cover.size())))
      if (!(without_voids && is_void(cover, c))) result.cells.push_back(c);
  };
  add(volumes);
  result.by_volume = std::ssize(result.cells);
  add(counts);
  return result;
}

template <int Dim>
Eigen::Matrix<double, Dim, Dim> find_patch_samples(const Cover<Dim>& cover, Index cell_index, Index n,
                                                   double anisotropy, typename Cover<Dim>::Search& search) {
  const Box<Dim>& cell = cover.cell(cell_index);
  const Point<Dim> center = cell.center();
  const double crowd = static_cast<double>(n) / static_cast<double>(std::max<Index>(1, cover.count(cell_index)));
  const double reach = reach_share * cell.diagonal() * std::pow(crowd, 1.0 / Dim);
  cover.nearest(center, n, reach, search);
  const Eigen::Matrix<double, Dim, Dim> metric = metric_of<Dim>(cover.points(), center, anisotropy, search.found);
  for (Index factor = widening; n <= most_spread && factor <= widest && lopsided<Dim>(cover.points(), search.found);
       factor *= widening) {
    cover.nearest(center, factor * n, 2 * reach, search);
    spread<Dim>(cover.points(), n, search.found);
    if (!narrower<Dim>(flat, cover.points(), search.found)) continue;
    // All on a line or plane: for a cell next to it, the nearest samples are only a part of those in its support.
    const double support = 0.5 * cover.growth() * cell.diagonal();
    cover.nearest(center, factor * n, reach, search);
    while (std::ssize(search.found) > n && search.found.back().first > support * support) search.found.pop_back();
    spread<Dim>(cover.points(), n, search.found);
  }
  return metric;
}

#define CSRBF_INSTANTIATE(Dim)                                                                              \
  template SpreadCells spread_cells<Dim>(const Cover<Dim>&, Index);                                         \
  template bool lopsided<Dim>(const Points<Dim>&, const std::vector<std::pair<double, std::uint32_t>>&);    \
  template Eigen::Matrix<double, Dim, Dim> find_patch_samples<Dim>(const Cover<Dim>&, Index, Index, double, \
                                                                   typename Cover<Dim>::Search&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
