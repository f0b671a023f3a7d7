#include "csrbf/approx/kriging/confirm_errors.hpp"

#include "csrbf/approx/global/axis_covariance.hpp"
#include "csrbf/approx/kriging/local_kriging.hpp"

#include <algorithm>
#include <numeric>

namespace csrbf {
namespace {

constexpr double gross = 8;       // deviations; of 5 to 15 all tell errors from peaks
constexpr double material = 0.5;  // of the range of the others

}  // namespace

template <int Dim>
void confirm_errors(const Samples<Dim>& samples, RobustWeights& weights) {
  if (weights.suspects.empty()) return;
  Samples<Dim> others = samples;
  others.weights = samples.all_weights();
  if (weights.factors.size() > 0) others.weights.array() *= weights.factors.array();
  for (const Index i : weights.suspects) others.weights[i] = 0;
  MergedSamples<Dim> merged = merge_duplicates(without_zero_weights(others));
  const auto covariance = estimate_axis_covariance(merged.samples, merged.replicates).best;
  if (!covariance) return;
  const Points<Dim> places = in_lengths<Dim>(samples.points, *covariance);
  others = std::move(merged.samples);
  others.points = in_lengths<Dim>(others.points, *covariance);
  std::vector<Index> all(static_cast<std::size_t>(others.size()));
  std::iota(all.begin(), all.end(), Index{0});
  const Index C = samples.components();
  const KrigingPatch<Dim> patch(others, in_lengths(*covariance, C), others.points.rowwise().mean(), all);
  const Eigen::RowVectorXd range = others.values.colwise().maxCoeff() - others.values.colwise().minCoeff();
  std::vector<Index> kept;
  for (const Index i : weights.suspects) {
    const Point<Dim> x = places.col(i);
    const Eigen::ArrayXd off = (samples.values.row(i).transpose() - patch.value(x)).array().abs();
    const Eigen::ArrayXd expected = (patch.share(x) * patch.scale()).array().sqrt();
    const bool is_error = (off > gross * expected && off > material * range.transpose().array()).any();
    (is_error ? weights.gross_errors : kept).push_back(i);
  }
  weights.suspects = std::move(kept);
  if (weights.gross_errors.empty()) return;
  std::sort(weights.gross_errors.begin(), weights.gross_errors.end());
  weights.factors = Eigen::VectorXd::Ones(samples.size());
  for (const Index i : weights.gross_errors) weights.factors[i] = 0;
}

#define CSRBF_INSTANTIATE(Dim) template void confirm_errors<Dim>(const Samples<Dim>&, RobustWeights&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
