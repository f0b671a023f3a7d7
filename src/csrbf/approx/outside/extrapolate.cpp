#include "csrbf/approx/outside/extrapolate.hpp"

#include "csrbf/approx/samples/average_field.hpp"
#include "csrbf/approx/samples/drift_field.hpp"
#include "csrbf/approx/samples/fitted_field.hpp"
#include "csrbf/approx/samples/sphere_field.hpp"
#include "csrbf/approx/transform/transformed_back.hpp"
#include "csrbf/core/error.hpp"

#include <cmath>
#include <utility>

namespace csrbf {
namespace {

// A field with other values outside its box, if that is where they are decided.
template <int Dim>
std::shared_ptr<const Field<Dim>> continued(const std::shared_ptr<const Field<Dim>>& field,
                                            Extrapolation extrapolation) {
  const auto* fitted = dynamic_cast<const FittedField<Dim>*>(field.get());
  require(fitted != nullptr, "extrapolation", "function", "of a segmentation", "has no samples");
  if constexpr (Dim <= largest_dimension) {
    if (const auto* sphere = dynamic_cast<const SphereField<Dim>*>(&fitted->inner())) {
      typename SphereField<Dim>::Parts parts = sphere->parts();
      if (parts.charts.size() != 1 || parts.space) return field;  // the whole sphere has no outside
      parts.charts[0].field = continued<Dim>(parts.charts[0].field, extrapolation);
      return std::make_shared<FittedField<Dim>>(std::make_shared<SphereField<Dim>>(std::move(parts), sphere->bounds()),
                                                fitted->frame());
    }
  }
  if (const auto* back = dynamic_cast<const TransformedBack<Dim>*>(&fitted->inner())) {
    typename TransformedBack<Dim>::Parts parts = back->parts();
    parts.mean = continued<Dim>(parts.mean, extrapolation);
    return std::make_shared<FittedField<Dim>>(std::make_shared<TransformedBack<Dim>>(std::move(parts)),
                                              fitted->frame());
  }
  require(dynamic_cast<const DriftField<Dim>*>(&fitted->inner()) == nullptr, "extrapolation", "function",
          "with a drift", "give the option to fit");
  auto frame = fitted->frame();
  frame.rim.setZero();
  frame.extrapolation = extrapolation;
  return std::make_shared<FittedField<Dim>>(fitted->inner_pointer(), frame);
}

// What variances_by() made a variance of, a likelier field and its variance; else the field, with its trend, and the
// variance itself.
template <int Dim>
std::pair<std::shared_ptr<const Field<Dim>>, std::shared_ptr<const Field<Dim>>> likely_field(
    const std::shared_ptr<const Field<Dim>>& field, const std::shared_ptr<const Field<Dim>>& variance) {
  const auto* fitted = dynamic_cast<const FittedField<Dim>*>(variance.get());
  const auto* errors = fitted != nullptr ? dynamic_cast<const AverageField<Dim>*>(&fitted->inner()) : nullptr;
  if (errors == nullptr || errors->other() == nullptr) return {continued<Dim>(field, Extrapolation::trend), variance};
  auto frame = fitted->frame();
  const auto spread =
      std::make_shared<const AverageField<Dim>>(errors->fields(), errors->weights(), errors->variances());
  const auto likely_variance = std::make_shared<const FittedField<Dim>>(spread, frame);
  frame.unit = std::sqrt(frame.unit);
  frame.growth = {};  // of variances
  const auto mean = std::make_shared<const AverageField<Dim>>(errors->fields(), errors->weights());
  return {std::make_shared<const FittedField<Dim>>(mean, frame), likely_variance};
}

}  // namespace

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> variances_by(
    const std::vector<std::shared_ptr<const Field<Dim>>>& fields,
    const std::vector<std::shared_ptr<const Field<Dim>>>& likely,
    const std::vector<std::shared_ptr<const Field<Dim>>>& variances) {
  auto frame = dynamic_cast<const FittedField<Dim>&>(*fields.front()).frame();
  frame.extrapolation = Extrapolation::trend;  // each of the fields has its own
  frame.scales.setOnes();
  frame.rim.setZero();
  frame.growth = {};
  frame.unit = 1;
  std::vector<std::shared_ptr<const Field<Dim>>> result;
  for (const auto& error : errors_of<Dim>(fields, likely, variances))
    result.push_back(std::make_shared<const FittedField<Dim>>(error, frame));
  return result;
}

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> with_errors_outside(
    const std::vector<std::shared_ptr<const Field<Dim>>>& fields,
    const std::vector<std::shared_ptr<const Field<Dim>>>& variances) {
  std::vector<std::shared_ptr<const Field<Dim>>> likely;
  for (const auto& field : fields) likely.push_back(continued<Dim>(field, Extrapolation::trend));
  return variances_by<Dim>(fields, likely, variances);
}

template <int Dim>
void bound_outside(const Samples<Dim>& samples, std::vector<std::shared_ptr<const Field<Dim>>>& variances) {
  constexpr Index few = 20;  // chosen by hand
  if (samples.size() < few) return;
  for (std::size_t c = 0; c < variances.size(); ++c) {
    const auto values = samples.values.col(static_cast<Index>(c));
    const auto& fitted = dynamic_cast<const FittedField<Dim>&>(*variances[c]);
    auto frame = fitted.frame();
    frame.growth.largest = std::pow(values.maxCoeff() - values.minCoeff(), 2);
    variances[c] = std::make_shared<const FittedField<Dim>>(fitted.inner_pointer(), frame);
  }
}

template <int Dim>
void extrapolate(std::vector<std::shared_ptr<const Field<Dim>>>& components,
                 std::vector<std::shared_ptr<const Field<Dim>>>& variances, bool has_trend,
                 Extrapolation extrapolation) {
  if (extrapolation == Extrapolation::trend && !has_trend) extrapolation = Extrapolation::linear;
  const auto* fitted = dynamic_cast<const FittedField<Dim>*>(components.front().get());
  bool is_sphere = false;
  if constexpr (Dim <= largest_dimension)
    is_sphere = fitted != nullptr && dynamic_cast<const SphereField<Dim>*>(&fitted->inner()) != nullptr;
  const bool is_back = fitted != nullptr && dynamic_cast<const TransformedBack<Dim>*>(&fitted->inner()) != nullptr;
  for (auto& field : components) field = continued<Dim>(field, extrapolation);
  for (auto& field : variances)  // they know the values, too
    if (is_back) field = continued<Dim>(field, extrapolation);
  if (variances.empty() || !has_trend || is_sphere || is_back) return;
  std::vector<std::shared_ptr<const Field<Dim>>> likely, likely_variances;
  for (std::size_t c = 0; c < variances.size(); ++c) {
    auto [mean, variance] = likely_field<Dim>(components[c], variances[c]);
    likely.push_back(std::move(mean));
    likely_variances.push_back(std::move(variance));
  }
  variances = variances_by<Dim>(components, likely, likely_variances);
}

#define CSRBF_INSTANTIATE(Dim)                                                                                       \
  template std::vector<std::shared_ptr<const Field<Dim>>> variances_by<Dim>(                                         \
      const std::vector<std::shared_ptr<const Field<Dim>>>&, const std::vector<std::shared_ptr<const Field<Dim>>>&,  \
      const std::vector<std::shared_ptr<const Field<Dim>>>&);                                                        \
  template std::vector<std::shared_ptr<const Field<Dim>>> with_errors_outside<Dim>(                                  \
      const std::vector<std::shared_ptr<const Field<Dim>>>&, const std::vector<std::shared_ptr<const Field<Dim>>>&); \
  template void bound_outside<Dim>(const Samples<Dim>&, std::vector<std::shared_ptr<const Field<Dim>>>&);            \
  template void extrapolate<Dim>(std::vector<std::shared_ptr<const Field<Dim>>>&,                                    \
                                 std::vector<std::shared_ptr<const Field<Dim>>>&, bool, Extrapolation);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
