#include "csrbf/approx/samples/merge_duplicates.hpp"

#include "csrbf/spatial/coincident_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace csrbf {
namespace {

// Neighbours of a list, from the one position to before the other.
struct Group {
  std::size_t begin, end;
};

double pairs_in(const std::vector<Group>& groups) {
  double sum = 0;
  for (const Group& group : groups) {
    const auto size = static_cast<double>(group.end - group.begin);
    sum += size * (size - 1) / 2;
  }
  return sum;
}

// Ends a group wherever `differ` says so of neighbours.
template <typename Differ>
std::vector<Group> groups_of(const std::vector<Index>& rows, Differ differ) {
  std::vector<Group> groups;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k == 0 || differ(rows[k - 1], rows[k])) groups.push_back({k, k});
    ++groups.back().end;
  }
  return groups;
}

// Chance that noise makes two of these values of one column at one place equal, by small ones of their differences, a
// tenth of which are no larger: the step of rounded or whole numbers. 1 without any difference.
double chance_of_equal(const Eigen::VectorXd& column, const std::vector<Index>& rows,
                       const std::vector<Group>& places) {
  double squares = 0;
  std::vector<double> steps;
  for (const Group& group : places) {
    std::vector<double> values;
    for (std::size_t k = group.begin; k < group.end; ++k) values.push_back(column[rows[k]]);
    std::sort(values.begin(), values.end());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    for (std::size_t k = 0; k < values.size(); ++k) {
      squares += std::pow(values[k] - mean, 2);
      if (k > 0 && values[k] > values[k - 1]) steps.push_back(values[k] - values[k - 1]);
    }
  }
  if (steps.empty()) return 1;
  const auto small = steps.begin() + std::ssize(steps) / 10;
  std::nth_element(steps.begin(), small, steps.end());
  const double noise = std::sqrt(squares / static_cast<double>(rows.size() - places.size()));
  return std::min(1.0, *small / (2 * std::sqrt(std::numbers::pi) * noise));
}

}  // namespace

template <int Dim>
void count_copies_once(Samples<Dim>& samples, const std::vector<Index>& place) {
  // Chosen by hand: equal pairs over those that noise makes, and the chance of these, above which they tell nothing.
  constexpr double clearly_more = 2, often = 0.1;
  constexpr double rounding = 1e-6;  // of the range: of numbers in single precision, or written with seven digits
  const Eigen::MatrixXd& values = samples.values;
  const auto at = [&](Index i) { return place[static_cast<std::size_t>(i)]; };
  std::vector<Index> count(place.size(), 0), rows;
  for (Index i = 0; i < samples.size(); ++i) count[static_cast<std::size_t>(at(i))] += samples.weight(i) > 0 ? 1 : 0;
  for (Index i = 0; i < samples.size(); ++i)
    if (samples.weight(i) > 0 && count[static_cast<std::size_t>(at(i))] > 1) rows.push_back(i);
  if (rows.empty()) return;
  std::sort(rows.begin(), rows.end(), [&](Index a, Index b) {
    if (at(a) != at(b)) return at(a) < at(b);
    for (Index c = 0; c < values.cols(); ++c)
      if (values(a, c) != values(b, c)) return values(a, c) < values(b, c);
    return a < b;
  });
  const Eigen::RowVectorXd range = values.colwise().maxCoeff() - values.colwise().minCoeff();
  const auto others = [&](Index a, Index b) { return at(a) != at(b); };
  const auto differ = [&](Index a, Index b) {
    return others(a, b) || ((values.row(a) - values.row(b)).array().abs() > rounding * range.array()).any();
  };
  const std::vector<Group> copies = groups_of(rows, differ);
  const double equal = pairs_in(copies), all = pairs_in(groups_of(rows, others));
  if (equal == 0) return;
  std::vector<Index> distinct;
  for (const Group& group : copies) distinct.push_back(rows[group.begin]);
  const std::vector<Group> places = groups_of(distinct, others);
  double chance = 1;
  for (Index c = 0; c < values.cols(); ++c) chance *= chance_of_equal(values.col(c), distinct, places);
  if (equal < all && (chance > often || equal <= clearly_more * chance * all)) return;
  samples.weights = samples.all_weights();
  for (const Group& group : copies)
    for (std::size_t k = group.begin + 1; k < group.end; ++k) {
      double& kept = samples.weights[rows[group.begin]];
      kept = std::max(kept, samples.weights[rows[k]]);
      samples.weights[rows[k]] = 0;
    }
}

template <int Dim>
MergedSamples<Dim> merge_duplicates(Samples<Dim> samples, DuplicateValue value) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Index n = samples.size();
  const auto& points = samples.points;
  const std::vector<Index> first = first_coincident<Dim>(points);
  Index distinct = 0;
  for (Index i = 0; i < n; ++i) distinct += first[i] == i ? 1 : 0;
  if (distinct == n) {
    MergedSamples<Dim> same{std::move(samples), Eigen::VectorXd::Zero(n), std::vector<Index>(first.size()), {}};
    std::iota(same.place.begin(), same.place.end(), Index{0});
    return same;
  }

  count_copies_once(samples, first);
  MergedSamples<Dim> merged;
  merged.place.resize(first.size());
  Samples<Dim>& m = merged.samples;
  m = {Points<Dim>(Dim, distinct), Eigen::MatrixXd::Zero(distinct, samples.components()),
       Eigen::VectorXd::Zero(distinct)};
  Eigen::VectorXd count = Eigen::VectorXd::Zero(distinct);
  Eigen::MatrixXd plain = m.values;
  merged.replicates.squares = Eigen::VectorXd::Zero(samples.components());
  Eigen::MatrixXd least = Eigen::MatrixXd::Constant(distinct, samples.components(), infinity);
  Eigen::MatrixXd largest = -least;
  Index next = 0;
  for (Index i = 0; i < n; ++i) {
    const Index leader = first[i];
    if (leader == i) m.points.col(next) = points.col(i);
    const Index place = leader == i ? next++ : merged.place[leader];
    merged.place[i] = place;
    // Running means: the mean of equal values is that value.
    count[place] += 1;
    least.row(place) = least.row(place).cwiseMin(samples.values.row(i));
    largest.row(place) = largest.row(place).cwiseMax(samples.values.row(i));
    plain.row(place) += (samples.values.row(i) - plain.row(place)) / count[place];
    const double before = m.weights[place];
    if (samples.weight(i) == 0) continue;
    m.weights[place] += samples.weight(i);
    const Eigen::RowVectorXd step = samples.values.row(i) - m.values.row(place);
    m.values.row(place) += samples.weight(i) / m.weights[place] * step;
    if (before == 0) continue;
    merged.replicates.squares += samples.weight(i) * before / m.weights[place] * step.cwiseAbs2().transpose();
    ++merged.replicates.count;
  }
  for (Index place = 0; place < distinct; ++place)
    if (m.weights[place] == 0) m.values.row(place) = plain.row(place);
  if (value == DuplicateValue::midrange) m.values = least + 0.5 * (largest - least);
  merged.spread = 0.5 * (largest - least).rowwise().maxCoeff();
  return merged;
}

#define CSRBF_INSTANTIATE(Dim)                                                    \
  template void count_copies_once<Dim>(Samples<Dim>&, const std::vector<Index>&); \
  template MergedSamples<Dim> merge_duplicates<Dim>(Samples<Dim>, DuplicateValue);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
