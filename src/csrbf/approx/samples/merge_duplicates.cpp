#include "csrbf/approx/samples/merge_duplicates.hpp"

#include "csrbf/spatial/coincident_points.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace csrbf {

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

  MergedSamples<Dim> merged;
  merged.place.resize(first.size());
  Samples<Dim>& m = merged.samples;
  m = {Points<Dim>(Dim, distinct), Eigen::MatrixXd::Zero(distinct, samples.components()),
       Eigen::VectorXd::Zero(distinct)};
  Eigen::VectorXd count = Eigen::VectorXd::Zero(distinct), heaviest = count;
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
    heaviest[place] = std::max(heaviest[place], samples.weight(i));
    const Eigen::RowVectorXd step = samples.values.row(i) - m.values.row(place);
    m.values.row(place) += samples.weight(i) / m.weights[place] * step;
    if (before == 0) continue;
    merged.replicates.squares += samples.weight(i) * before / m.weights[place] * step.cwiseAbs2().transpose();
    ++merged.replicates.count;
  }
  for (Index place = 0; place < distinct; ++place)
    if (m.weights[place] == 0) m.values.row(place) = plain.row(place);
  constexpr double rounding = 1e-6;  // of the range: of numbers in single precision, or written with seven digits
  const Eigen::RowVectorXd range = largest.colwise().maxCoeff() - least.colwise().minCoeff();
  if (((largest - least).colwise().maxCoeff().array() <= rounding * range.array()).all()) {
    // Copies: they say nothing that one of them does not.
    merged.replicates = {};
    m.weights = heaviest;
  }
  if (value == DuplicateValue::midrange) m.values = least + 0.5 * (largest - least);
  merged.spread = 0.5 * (largest - least).rowwise().maxCoeff();
  return merged;
}

#define CSRBF_INSTANTIATE(Dim) template MergedSamples<Dim> merge_duplicates<Dim>(Samples<Dim>, DuplicateValue);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
