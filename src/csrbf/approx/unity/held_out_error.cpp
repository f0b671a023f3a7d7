#include "csrbf/approx/unity/held_out_error.hpp"

#include "csrbf/approx/unity/fit_patches.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/even_pairs.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

namespace csrbf {
namespace {

constexpr Index most_held_out = 5000;  // samples, or about so many; chosen by hand

// A fold holds out one of so many samples: ten, as is conventional, or more.
Index one_in(Index n) {
  return std::max<Index>(10, n / most_held_out);
}

// Gaps around random places among points.
template <int Dim>
struct Gaps {
  std::vector<Index> nearest;  // of the points, to the place
  std::vector<double> radii;   // of balls without points

  // Places are between a few of the points that are spread evenly over all, and a gap is as wide as places beside it
  // are far from the points.
  Gaps(const Points<Dim>& points, const KdTree<Dim>& tree) : nearest(count), radii(count) {
    std::vector<Index> all(static_cast<std::size_t>(points.cols()));
    std::iota(all.begin(), all.end(), 0);
    const Points<Dim> some = chosen_points<Dim>(points, even_samples(all, looked_at));
    const Points<Dim> corners = chosen_points<Dim>(some, farthest_points<Dim>(some, spread).indices);
    std::mt19937_64 random(1);  // its sequence is fixed by the standard
    Points<Dim> places(Dim, count);
    std::vector<double> distances(count);
    for (Index k = 0; k < count; ++k) {
      Point<Dim> sum = Point<Dim>::Zero();
      double weights = 0;
      for (int corner = 0; corner <= Dim; ++corner) {
        const double weight = 1e-9 - std::log(std::ldexp(static_cast<double>(random() >> 1) + 1, -63));
        sum += weight * corners.col(static_cast<Index>(random() % static_cast<std::uint64_t>(corners.cols())));
        weights += weight;
      }
      places.col(k) = sum / weights;
      const auto i = static_cast<std::size_t>(k);
      double r2 = 0;
      tree.nearest(places.col(k), 1, &nearest[i], &r2);
      distances[i] = std::sqrt(r2);
    }
    const KdTree<Dim> tree_of_places(places);
    for (Index k = 0; k < count; ++k) {
      std::array<Index, beside> found = {};
      std::array<double, beside> r2 = {};
      tree_of_places.nearest(places.col(k), beside, found.data(), r2.data());
      for (const Index i : found) {
        double& radius = radii[static_cast<std::size_t>(k)];
        radius = std::max(radius, distances[static_cast<std::size_t>(i)]);
      }
    }
  }

  // Whether they are wider than the points are far from so many neighbours as a lattice has. They are by .78 in the
  // plane and .73 in space for random points, by .54 and .65 for a lattice.
  [[nodiscard]] bool are_wide(const Points<Dim>& points, const KdTree<Dim>& tree) const {
    constexpr double wide = 0.85;             // chosen by hand
    constexpr Index neighbors = 2 * Dim + 1;  // with the point itself
    const Index n = points.cols(), asked = std::min<Index>(n, count);
    std::vector<double> distances;
    std::array<Index, neighbors> found = {};
    std::array<double, neighbors> r2 = {};
    for (Index k = 0; k < asked; ++k) {
      tree.nearest(points.col((2 * k + 1) * n / (2 * asked)), neighbors, found.data(), r2.data());
      distances.push_back(std::sqrt(r2.back()));
    }
    return median(std::vector<double>(radii)) > wide * median(distances);
  }

  // Chosen by hand.
  static constexpr Index count = 1000, beside = 6, looked_at = 10'000, spread = 1000;
};

}  // namespace

template <int Dim>
std::optional<HeldOutRows> held_out_in_gaps(const Points<Dim>& given) {
  if constexpr (Dim == 1 || Dim > 3) {
    return std::nullopt;
  } else {
    // Chosen by hand.
    constexpr Index most_asked = 400, fewest_asked = 24, asked_of_each = 5;
    constexpr double apart = 1.5;  // centres of gaps over the sum of their radii
    constexpr Index share = 5;     // at most one in so many is left out
    const std::vector<Index> order = morton_order<Dim>(given);
    const Points<Dim> points = chosen_points<Dim>(given, order);
    const Index n = points.cols();
    if (n < 2 * fewest_asked) return std::nullopt;
    const KdTree<Dim> tree(points);
    const Gaps<Dim> gaps(points, tree);
    if (!gaps.are_wide(points, tree)) return std::nullopt;
    std::vector<std::size_t> moved;
    std::vector<Index> within, left_out, asked;
    const auto center = [&](std::size_t k) { return points.col(gaps.nearest[k]); };
    for (std::size_t k = 0; k < gaps.radii.size() && std::ssize(asked) < most_asked; ++k) {
      const double radius = gaps.radii[k];
      const bool is_free = std::none_of(moved.begin(), moved.end(), [&](std::size_t other) {
        return (center(k) - center(other)).norm() < apart * (gaps.radii[other] + radius);
      });
      if (!(radius > 0) || !is_free) continue;
      tree.within(center(k), radius, within);
      if (share * (std::ssize(left_out) + std::ssize(within)) > n) continue;
      moved.push_back(k);
      left_out.insert(left_out.end(), within.begin(), within.end());
      const std::vector<Index> some = even_samples(within, asked_of_each);
      asked.insert(asked.end(), some.begin(), some.end());
    }
    if (std::ssize(asked) < fewest_asked) return std::nullopt;
    const auto given_row = [&](Index i) { return order[static_cast<std::size_t>(i)]; };
    std::vector<char> is_other(static_cast<std::size_t>(n), 1);
    for (const Index i : left_out) is_other[static_cast<std::size_t>(given_row(i))] = 0;
    HeldOutRows rows;
    for (const Index i : asked) rows.asked.push_back(given_row(i));
    std::sort(rows.asked.begin(), rows.asked.end());
    for (Index i = 0; i < n; ++i)
      if (is_other[static_cast<std::size_t>(i)] != 0) rows.others.push_back(i);
    return rows;
  }
}

template <int Dim>
HeldOutSamples<Dim>::HeldOutSamples(const Samples<Dim>& samples, const HeldOutRows& rows)
    : kept_(chosen_samples(samples, rows.others)), held_out_(chosen_samples(samples, rows.asked)) {}

template <int Dim>
HeldOutSamples<Dim>::HeldOutSamples(const Samples<Dim>& samples, Index fold) {
  const std::vector<Index> order = morton_order<Dim>(samples.points);
  const Index stride = one_in(samples.size());
  std::vector<Index> kept, held_out;
  for (Index i = 0; i < samples.size(); ++i)
    (i % stride == (stride / 2 + fold) % stride ? held_out : kept).push_back(order[i]);
  kept_ = chosen_samples(samples, kept);
  held_out_ = chosen_samples(samples, held_out);
}

template <int Dim>
Index HeldOutSamples<Dim>::folds(Index n) {
  const Index stride = one_in(n);
  return std::clamp<Index>(most_held_out * stride / n, 1, stride);
}

template <int Dim>
Eigen::MatrixXd HeldOutSamples<Dim>::errors(const LocalOptions& options) const {
  const PartitionOfUnityFit<Dim> fit{fit_patches<Dim>(kept_, options, {}, &held_out_.points), {}};
  return errors(fit.fields());
}

template <int Dim>
Eigen::MatrixXd HeldOutSamples<Dim>::errors(const std::vector<std::shared_ptr<const Field<Dim>>>& fields) const {
  Eigen::MatrixXd error = held_out_.values;
  Index component = 0;
  for (const auto& field : fields) error.col(component++) -= field->evaluate(held_out_.points).value;
  return error;
}

#define CSRBF_INSTANTIATE(Dim)                                                   \
  template std::optional<HeldOutRows> held_out_in_gaps<Dim>(const Points<Dim>&); \
  template class HeldOutSamples<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
