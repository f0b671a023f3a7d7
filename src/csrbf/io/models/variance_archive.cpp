#include "csrbf/io/models/variance_archive.hpp"

#include "csrbf/io/models/field_parts.hpp"

#include <cmath>
#include <utility>

namespace csrbf {

template <int Dim>
Archive power_to_archive(const PowerFunction<Dim>& power) {
  Archive archive;
  archive.kind = power_kind;
  archive.set("degree", power.degree());
  archive.set("smoothing", power.smoothing());
  archive.set("weights", power.weights());
  return archive;
}

template <int Dim>
std::shared_ptr<const PowerFunction<Dim>> power_from(const Archive& archive,
                                                     std::shared_ptr<const RadialBasis<Dim>> basis) {
  const double smoothing = archive.number("smoothing");
  const Eigen::VectorXd weights = archive.numbers("weights", -1, 1);
  if (!(smoothing >= 0) || !(weights.size() == 0 || weights.minCoeff() > 0)) archive.fail("the smoothing is damaged");
  const auto degree = static_cast<int>(archive.integer("degree", -1, most_degree));
  return std::make_shared<const PowerFunction<Dim>>(std::move(basis), degree, smoothing, weights);
}

template <int Dim>
Archive variance_to_archive(const KrigingVariance<Dim>& variance) {
  Archive archive;
  archive.kind = variance_kind;
  archive.set("sigma2", variance.sigma2());
  if (variance.growth().factor > 1) {
    archive.set("growth_distance", variance.growth().distance);
    archive.set("growth_factor", variance.growth().factor);
  }
  if (variance.growth().least > 0) archive.set("growth_least", variance.growth().least);
  set_box(archive, variance.bounds());
  return archive;
}

template <int Dim>
std::shared_ptr<const KrigingVariance<Dim>> variance_from(const Archive& archive,
                                                          std::shared_ptr<const PowerFunction<Dim>> power) {
  const double sigma2 = archive.number("sigma2");
  if (!(sigma2 >= 0) || !std::isfinite(sigma2)) archive.fail("the variance is damaged");
  ErrorGrowth growth;
  if (archive.has("growth_factor")) {
    growth = {archive.number("growth_distance"), archive.number("growth_factor")};
    const bool grows = growth.factor > 1 && growth.distance > 1;
    if (!grows || !std::isfinite(growth.factor * growth.distance)) archive.fail("the variance is damaged");
  }
  if (archive.has("growth_least")) growth.least = archive.number("growth_least");
  if (!(growth.least >= 0 && growth.least <= 1)) archive.fail("the variance is damaged");
  return std::make_shared<const KrigingVariance<Dim>>(power, sigma2, box_of<Dim>(archive), growth);
}

template <int Dim>
Archive places_to_archive(const SamplePlaces<Dim>& places) {
  Archive archive;
  archive.kind = places_kind;
  archive.set("points", places.points());
  return archive;
}

template <int Dim>
std::shared_ptr<const SamplePlaces<Dim>> places_from(const Archive& archive) {
  Points<Dim> points = archive.numbers("points", Dim);
  if (points.cols() == 0 || !points.allFinite()) archive.fail("the places of samples are damaged");
  return std::make_shared<const SamplePlaces<Dim>>(std::move(points));
}

template <int Dim>
Archive grown_to_archive(const GrownVariance<Dim>& field, const std::function<Archive(const Field<Dim>&)>& to_archive) {
  Archive archive;
  archive.kind = grown_kind;
  archive.set("variance", to_archive(field.variance()));
  archive.set("spacing", to_archive(field.spacing()));
  archive.set("amount", field.growth().amount);
  archive.set("exponent", field.growth().exponent);
  return archive;
}

template <int Dim>
std::shared_ptr<const GrownVariance<Dim>> grown_from(
    const Archive& archive, std::shared_ptr<const SamplePlaces<Dim>> places,
    const std::function<std::shared_ptr<const Field<Dim>>(const Archive&)>& from_archive) {
  const GrowthWithDistance growth{archive.number("amount"), archive.number("exponent")};
  const Archive variance = archive.part("variance"), spacing = archive.part("spacing");
  const bool is_finite = growth.amount >= 0 && growth.exponent >= 0 && std::isfinite(growth.amount + growth.exponent);
  if (!is_finite || variance.kind == grown_kind || spacing.kind == grown_kind) archive.fail("the variance is damaged");
  return std::make_shared<const GrownVariance<Dim>>(from_archive(variance), from_archive(spacing), std::move(places),
                                                    growth);
}
#define CSRBF_INSTANTIATE(Dim)                                                                                 \
  template Archive power_to_archive<Dim>(const PowerFunction<Dim>&);                                           \
  template std::shared_ptr<const PowerFunction<Dim>> power_from<Dim>(const Archive&,                           \
                                                                     std::shared_ptr<const RadialBasis<Dim>>); \
  template Archive variance_to_archive<Dim>(const KrigingVariance<Dim>&);                                      \
  template std::shared_ptr<const KrigingVariance<Dim>> variance_from<Dim>(const Archive&,                      \
                                                                          std::shared_ptr<const PowerFunction<Dim>>);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

#define CSRBF_INSTANTIATE(Dim)                                                                                         \
  template Archive places_to_archive<Dim>(const SamplePlaces<Dim>&);                                                   \
  template std::shared_ptr<const SamplePlaces<Dim>> places_from<Dim>(const Archive&);                                  \
  template Archive grown_to_archive<Dim>(const GrownVariance<Dim>&, const std::function<Archive(const Field<Dim>&)>&); \
  template std::shared_ptr<const GrownVariance<Dim>> grown_from<Dim>(                                                  \
      const Archive&, std::shared_ptr<const SamplePlaces<Dim>>,                                                        \
      const std::function<std::shared_ptr<const Field<Dim>>(const Archive&)>&);
CSRBF_INSTANTIATE(1)
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
