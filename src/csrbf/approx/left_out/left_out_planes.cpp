#include "csrbf/approx/left_out/left_out_planes.hpp"

#include "csrbf/approx/kriging/local_kriging.hpp"
#include "csrbf/approx/unity/held_out_error.hpp"
#include "csrbf/spatial/even_pairs.hpp"

#include <algorithm>
#include <limits>

namespace csrbf {
namespace {

constexpr Index planes = 4, held = 12, others = 200, least_in_plane = 4;  // chosen by hand
constexpr double same = 1e-9;                                             // coordinates, in the extent of their axis

// The samples in the order of a coordinate, and where its values change.
struct Planes {
  std::vector<Index> order, first;

  [[nodiscard]] Index count() const { return std::ssize(first) - 1; }
  [[nodiscard]] std::vector<Index> samples(Index k) const {
    return {order.begin() + first[static_cast<std::size_t>(k)], order.begin() + first[static_cast<std::size_t>(k) + 1]};
  }
};

Planes planes_along(const Eigen::VectorXd& x) {
  Planes result;
  result.order.resize(static_cast<std::size_t>(x.size()));
  for (Index i = 0; i < x.size(); ++i) result.order[static_cast<std::size_t>(i)] = i;
  std::sort(result.order.begin(), result.order.end(),
            [&](Index a, Index b) { return x[a] < x[b] || (x[a] == x[b] && a < b); });
  const double tolerance = same * (x.maxCoeff() - x.minCoeff());
  double last = -std::numeric_limits<double>::infinity();
  for (Index k = 0; k < x.size(); ++k) {
    const double here = x[result.order[static_cast<std::size_t>(k)]];
    if (here > last + tolerance) result.first.push_back(k);
    last = here;
  }
  result.first.push_back(x.size());
  return result;
}

// The `count` of them that are nearest to a point.
template <int Dim>
void keep_nearest(std::vector<Index>& rows, const Points<Dim>& x, const Point<Dim>& center, Index count) {
  if (std::ssize(rows) <= count) return;
  const auto distance = [&](Index i) { return (x.col(i) - center).squaredNorm(); };
  std::nth_element(rows.begin(), rows.begin() + count, rows.end(),
                   [&](Index a, Index b) { return std::pair(distance(a), a) < std::pair(distance(b), b); });
  rows.resize(static_cast<std::size_t>(count));
}

// The mean squares of errors over their expected shares, of samples predicted from others around a center.
template <int Dim>
void add_ratios(const Samples<Dim>& scaled, const Covariance& model, const Point<Dim>& center,
                const std::vector<Index>& inside, const std::vector<Index>& outside, Eigen::VectorXd& sum,
                double& count) {
  const KrigingPatch<Dim> patch(scaled, model, center, outside);
  for (const Index i : inside) {
    const Point<Dim> x = scaled.points.col(i);
    const double share = patch.share(x);
    if (!(share > 0)) continue;
    sum += (scaled.values.row(i).transpose() - patch.value(x)).array().square().matrix() / share;
    count += 1;
  }
}

}  // namespace

template <int Dim>
Eigen::VectorXd variance_by_planes(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance) {
  Samples<Dim> scaled = samples;
  scaled.points = in_lengths<Dim>(samples.points, covariance);
  const Index n = samples.size(), C = samples.components();
  const Covariance model = in_lengths(covariance, C);
  Eigen::VectorXd largest;
  for (int a = 0; a < Dim; ++a) {
    const Planes along = planes_along(samples.points.row(a));
    const Index m = along.count();
    if (m < 3 || n < least_in_plane * m) continue;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(C);
    double count = 0;
    const Index tried = std::min(planes, m - 2);
    for (Index p = 0; p < tried; ++p) {
      const Index k = 1 + (2 * p + 1) * (m - 2) / (2 * tried);
      std::vector<Index> inside = along.samples(k), outside;
      const Point<Dim> center = scaled.points.col(inside[inside.size() / 2]);
      std::vector<char> is_inside(static_cast<std::size_t>(n), 0);
      for (const Index i : inside) is_inside[static_cast<std::size_t>(i)] = 1;
      for (Index i = 0; i < n; ++i)
        if (is_inside[static_cast<std::size_t>(i)] == 0) outside.push_back(i);
      keep_nearest<Dim>(inside, scaled.points, center, held);
      keep_nearest<Dim>(outside, scaled.points, center, others);
      add_ratios(scaled, model, center, inside, outside, sum, count);
    }
    if (!(count > 0) || !sum.allFinite()) continue;
    if (largest.size() == 0) largest = Eigen::VectorXd::Zero(C);
    largest = largest.cwiseMax(sum / count);
  }
  if constexpr (Dim <= largest_dimension)
    if (const auto gaps = held_out_in_gaps<Dim>(scaled.points)) {
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(C);
      double count = 0;
      for (const Index i : even_samples(gaps->asked, planes * held)) {
        const Point<Dim> center = scaled.points.col(i);
        std::vector<Index> outside = gaps->others;
        keep_nearest<Dim>(outside, scaled.points, center, others);
        add_ratios(scaled, model, center, {i}, outside, sum, count);
      }
      if (count > 0 && sum.allFinite())
        largest = largest.size() == 0 ? Eigen::VectorXd(sum / count) : Eigen::VectorXd(largest.cwiseMax(sum / count));
    }
  return largest;
}

#define CSRBF_INSTANTIATE(Dim) \
  template Eigen::VectorXd variance_by_planes<Dim>(const Samples<Dim>&, const AxisCovariance<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
