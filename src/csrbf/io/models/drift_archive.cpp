#include "csrbf/io/models/drift_archive.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/models/field_parts.hpp"

#include <type_traits>

namespace csrbf {
namespace {

Archive any_field_to_archive(const AnyField& any) {
  Archive archive;
  std::visit(
      [&](const auto& field) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(field)>, std::monostate>) {
          archive = alone(*field);
          archive.set("dimension", [&]<int E>(const Field<E>&) { return E; }(*field));
        }
      },
      any);
  return archive;
}

AnyField any_field_from(const Archive& archive) {
  switch (archive.integer("dimension")) {
#define CSRBF_CASE(E) \
  case E:             \
    return alone_from<E>(archive);
    CSRBF_FOR_MANY_DIMS(CSRBF_CASE)
#undef CSRBF_CASE
    default:
      archive.fail("fields of this dimension are not supported by this version");
  }
}

}  // namespace

template <int Dim>
Archive drift_to_archive(const DriftField<Dim>& field) {
  const typename DriftField<Dim>::Parts& parts = field.parts();
  Archive archive;
  archive.kind = drift_kind;
  set_box(archive, field.bounds());
  archive.set("drift", std::vector<std::int32_t>(parts.drift.begin(), parts.drift.end()));
  archive.set("beta", parts.beta);
  archive.set("field", any_field_to_archive(parts.field));
  archive.set("covariates", parts.covariates.size());
  archive.set("covariance", parts.covariance);
  for (std::size_t j = 0; j < parts.covariates.size(); ++j)
    archive.set("covariate" + std::to_string(j), any_field_to_archive(parts.covariates[j]));
  return archive;
}

template <int Dim>
std::shared_ptr<const Field<Dim>> drift_field_from(const Archive& archive) {
  typename DriftField<Dim>::Parts parts;
  const auto& drift = archive.array<std::int32_t>("drift", -1, 1);
  if (drift.size() == 0 || drift.size() >= Dim) archive.fail("the axes of the drift are damaged");
  parts.drift.assign(drift.data(), drift.data() + drift.size());
  parts.beta = archive.numbers("beta", drift.size(), 1);
  parts.field = any_field_from(archive.part("field"));
  for (std::int64_t j = 0, count = archive.integer("covariates", 0, drift.size()); j < count; ++j)
    parts.covariates.push_back(any_field_from(archive.part("covariate" + std::to_string(j))));
  parts.covariance = archive.numbers("covariance", std::ssize(parts.covariates), std::ssize(parts.covariates));
  return std::make_shared<const DriftField<Dim>>(std::move(parts), box_of<Dim>(archive));
}

#define CSRBF_INSTANTIATE(Dim)                                    \
  template Archive drift_to_archive<Dim>(const DriftField<Dim>&); \
  template std::shared_ptr<const Field<Dim>> drift_field_from<Dim>(const Archive&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
