#include "csrbf/approx/unity/held_out_error.hpp"

#include "csrbf/approx/unity/fit_patches.hpp"
#include "csrbf/spatial/morton_order.hpp"

namespace csrbf {
namespace {

constexpr Index most_held_out = 5000;  // samples, or about so many; chosen by hand

// A fold holds out one of so many samples: ten, as is conventional, or more.
Index one_in(Index n) {
  return std::max<Index>(10, n / most_held_out);
}

}  // namespace

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

#define CSRBF_INSTANTIATE(Dim) template class HeldOutSamples<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
