#include "csrbf/approx/replicate_noise.hpp"

#include "csrbf/approx/samples/average_field.hpp"
#include "csrbf/approx/unity/local_variance.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

// Of the samples at each of the first places: the weighted sum of the squared differences to their mean, components x
// places, and their weight.
struct Scatter {
  Eigen::MatrixXd squares;
  Eigen::VectorXd weight;
};

template <int Dim>
Scatter scatter_of(const Samples<Dim>& samples, const std::vector<Index>& place, Index places) {
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(samples.components(), places), squares = mean;
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(places);
  for (Index i = 0; i < samples.size(); ++i) {
    const Index k = place[static_cast<std::size_t>(i)];
    const double before = weight[k], w = samples.weight(i);
    if (w == 0) continue;
    weight[k] += w;
    const Eigen::VectorXd step = samples.values.row(i).transpose() - mean.col(k);
    mean.col(k) += w / weight[k] * step;
    squares.col(k) += w * before / weight[k] * step.cwiseAbs2();
  }
  return {squares, weight};
}

}  // namespace

template <int Dim>
void add_replicate_noise(const Samples<Dim>& samples, const std::vector<Index>& place, const Replicates& replicates,
                         const Points<Dim>& places, MethodFields<Dim>& fields) {
  if (replicates.count == 0) return;
  const Index known = 1 + *std::max_element(place.begin(), place.begin() + samples.size());
  Scatter scatter;
  if (fields.method == FitMethod::interpolate) {
    const Eigen::VectorXd noise = replicates.squares / static_cast<double>(replicates.count);
    fields.noise.resize(static_cast<std::size_t>(noise.size()), 0);
    scatter = {Eigen::MatrixXd(noise.size(), known), Eigen::VectorXd::Ones(known)};
    const double of_means = static_cast<double>(known) / static_cast<double>(known + replicates.count);
    for (Index c = 0; c < noise.size(); ++c) {
      double& deviation = fields.noise[static_cast<std::size_t>(c)];
      const double unknown = std::max(0.0, noise[c] - deviation * deviation);
      scatter.squares.row(c).setConstant((1 + of_means) * unknown);
      deviation = std::sqrt(deviation * deviation + unknown);
    }
  } else {
    Samples<Dim> once = samples;
    count_copies_once(once, place);
    scatter = scatter_of(once, place, known);
  }
  if constexpr (Dim <= largest_dimension) {
    auto noise = local_means<Dim>(places.leftCols(known), scatter.squares, scatter.weight);
    if (fields.variances.empty() && known == 1) {
      fields.variances = std::move(noise);
      return;
    }
    for (std::size_t c = 0; c < fields.variances.size(); ++c)
      fields.variances[c] = std::make_shared<const AverageField<Dim>>(
          std::vector<std::shared_ptr<const Field<Dim>>>{fields.variances[c], noise[c]}, std::vector<double>{1, 1});
  }
}

#define CSRBF_INSTANTIATE(Dim)                                                                              \
  template void add_replicate_noise<Dim>(const Samples<Dim>&, const std::vector<Index>&, const Replicates&, \
                                         const Points<Dim>&, MethodFields<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
