#include "csrbf/approx/kriging/patch_errors.hpp"

#include "csrbf/approx/unity/patch_samples.hpp"
#include "csrbf/core/percentile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace csrbf {
namespace {

// Samples in a ball without any that is no gap yet: by chance one in e^9 is so. More in space, where a cell has three
// times as many places to look at.
template <int Dim>
constexpr double expected_in_empty = Dim == 3 ? 14 : 9;

constexpr double largest = 1e100;  // factor of an error; keeps the product finite
constexpr double uneven = 0.25;    // usual distance over the mean one, below which there is a gap; chosen by hand

// The one that equals the mean for places at random and for even ones, if a gap or two tell the mean from it; infinite
// where samples come in bursts.
double usual_interval(std::vector<double> places) {
  constexpr double usual = 0.632;  // 1 - 1 / e
  constexpr std::size_t gaps = 2;
  std::sort(places.begin(), places.end());
  std::vector<double> intervals;
  for (std::size_t i = 1; i < places.size(); ++i) intervals.push_back(places[i] - places[i - 1]);
  if (intervals.size() <= 2 * gaps) return std::numeric_limits<double>::infinity();
  std::sort(intervals.begin(), intervals.end());
  const auto others = intervals.end() - gaps;
  const double mean = std::accumulate(intervals.begin(), others, 0.0) / static_cast<double>(intervals.size() - gaps);
  const double found = percentile(intervals, usual);
  return found > uneven * mean ? found : std::numeric_limits<double>::infinity();
}

}  // namespace

template <int Dim>
PatchErrors<Dim>::PatchErrors(const PartitionOfUnityFit<Dim>& fit)
    : fit_(fit),
      cover_(fit.data->cover),
      basis_(fit.report.local.degree),
      samples_(std::min(fit.report.local.samples, cover_.points().cols())),
      unknowns_(std::clamp<Index>(basis_.size() + fit.data->models.centers_each, 1, samples_)),  // 0: all patches are 0
      interpolates_(fit.data->models.centers_each == samples_),
      gap_(std::pow(expected_in_empty<Dim> / static_cast<double>(unknowns_), 1.0 / Dim)),
      spacing_(std::pow(unit_ball_volume<Dim> / static_cast<double>(unknowns_), 1.0 / Dim)) {}

template <int Dim>
double PatchErrors<Dim>::expected() const {
  return expected_in_empty<Dim>;
}

template <int Dim>
void PatchErrors<Dim>::enter(Index cell, const Eigen::VectorXd& error, Patch& patch) const {
  patch.cell = cell;
  patch.error = error;
  patch.center = fit_.data->models.center.col(cell);
  patch.radius = fit_.data->models.radius[cell];
}

template <int Dim>
void PatchErrors<Dim>::prepare(Patch& patch) const {
  find_patch_samples(cover_, patch.cell, samples_, 0, patch.search);
  patch.q.resize(Dim, std::ssize(patch.search.found));
  for (Index k = 0; k < patch.q.cols(); ++k)
    patch.q.col(k) = (cover_.points().col(patch.search.found[k].second) - patch.center) / patch.radius;
  constexpr double rounding = 1e-14;  // relative, as in LocalFitter
  patch.rows.resize(patch.q.cols(), basis_.size());
  if (basis_.size() > 0) {
    basis_.rows(patch.q, patch.rows.data());
    Eigen::MatrixXd gram = patch.rows.transpose() * patch.rows;
    gram.diagonal().array() += rounding * gram.trace() / static_cast<double>(basis_.size());
    patch.gram.compute(gram);
  }
  if (!interpolates_) return;
  Eigen::MatrixXd A(patch.q.cols(), patch.q.cols());
  for (Index j = 0; j < A.cols(); ++j) A.col(j) = radial(patch.q.col(j), patch);
  A.diagonal().array() += fit_.report.local.smoothing + static_cast<double>(A.rows()) * rounding;
  patch.radial.compute(A);
}

// The radial functions of a patch at q.
template <int Dim>
Eigen::VectorXd PatchErrors<Dim>::radial(const Point<Dim>& q, const Patch& patch) const {
  const LocalModels<Dim>& models = fit_.data->models;
  const Eigen::VectorXd r2 =
      (patch.q.colwise() - q).colwise().squaredNorm().transpose() / (models.support * models.support);
  Eigen::VectorXd phi(r2.size());
  models.kernel.values(r2.data(), r2.size(), phi.data());
  return phi;
}

// Sum of the squares of the weights of the samples in the value of the local function at q: what errors of theirs are
// magnified by. Without radial functions at all of them, that of the polynomial.
template <int Dim>
double PatchErrors<Dim>::magnified(const Point<Dim>& q, const Patch& patch) const {
  Eigen::VectorXd row(basis_.size());
  if (basis_.size() > 0) basis_.rows(q, row.data());
  if (!interpolates_) {
    if (basis_.size() == 0) return 0;
    return (patch.rows * solve(patch.gram, row)).squaredNorm();
  }
  Eigen::VectorXd w = solve(patch.radial, radial(q, patch));
  row -= patch.rows.transpose() * w;
  if (basis_.size() > 0) w += patch.rows * solve(patch.gram, row);
  return w.squaredNorm();
}

template <int Dim>
double PatchErrors<Dim>::growth(double distance, double spacing, const Patch& patch) const {
  const double wider = std::max({1.0, distance / spacing, spacing_ * patch.radius / spacing});
  return std::pow(wider, 2 * std::max(1, basis_.degree() + 1));
}

template <int Dim>
Eigen::VectorXd PatchErrors<Dim>::least_error(double distance, double spacing, const Patch& patch) const {
  return std::min(largest, growth(distance, spacing, patch)) * patch.error;
}

template <int Dim>
Eigen::VectorXd PatchErrors<Dim>::error(const Point<Dim>& x, double distance, double spacing,
                                        const Patch& patch) const {
  const double own = 1 + magnified((x - patch.center) / patch.radius, patch);
  return std::min(largest, growth(distance, spacing, patch) * own) * patch.error;
}

template <int Dim>
double PatchErrors<Dim>::usual_reach(Index n, const typename Cover<Dim>::Search& search) const {
  const double reach = std::sqrt(search.found[static_cast<std::size_t>(n - 1)].first);
  if constexpr (Dim == 1) {
    std::vector<double> places;
    for (const auto& [distance2, id] : search.found) places.push_back(cover_.points()(0, id));
    const double usual = 0.5 * static_cast<double>(n) * usual_interval(std::move(places));
    if (usual < uneven * reach) return usual;
  }
  return reach;
}

template <int Dim>
double PatchErrors<Dim>::spacing_at(const Point<Dim>& x, Patch& patch) const {
  constexpr Index telling = Dim == 1 ? 16 : 0;  // samples
  const Index all = cover_.points().cols(), n = std::min(unknowns_, all);
  cover_.nearest(x, std::min(all, std::max(n, telling)), patch.radius, patch.search);
  return spacing_ * usual_reach(n, patch.search);
}

template <int Dim>
double PatchErrors<Dim>::nearest(const Point<Dim>& x, double reach, typename Cover<Dim>::Search& search) const {
  cover_.nearest(x, 1, reach, search);
  return std::sqrt(search.found.front().first);
}

#define CSRBF_INSTANTIATE(Dim) template class PatchErrors<Dim>;
CSRBF_INSTANTIATE(1)
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
