#include "csrbf/io/models/average_archive.hpp"

#include <string>
#include <utility>
#include <vector>

namespace csrbf {
namespace {

constexpr Index most_averaged = 64;     // limit on damaged files, above what fits make
constexpr std::int64_t of_another = 2;  // has_variances: of the errors of another field

}  // namespace

template <int Dim>
Archive average_to_archive(const AverageField<Dim>& field,
                           const std::function<Archive(const Field<Dim>&)>& to_archive) {
  Archive archive;
  archive.kind = average_kind;
  const std::vector<double>& weights = field.weights();
  archive.set("weights", Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(weights.data(), std::ssize(weights))));
  archive.set("has_variances", field.variances().empty() ? 0 : field.other() == nullptr ? 1 : of_another);
  for (std::size_t i = 0; i < field.fields().size(); ++i) {
    archive.set("field" + std::to_string(i), to_archive(*field.fields()[i]));
    if (!field.variances().empty()) archive.set("variance" + std::to_string(i), to_archive(*field.variances()[i]));
  }
  if (field.other() != nullptr) archive.set("other", to_archive(*field.other()));
  return archive;
}

template <int Dim>
std::shared_ptr<const Field<Dim>> average_from(
    const Archive& archive, const std::function<std::shared_ptr<const Field<Dim>>(const Archive&)>& from_archive) {
  const Eigen::VectorXd weights = archive.numbers("weights", -1, 1);
  const std::int64_t kind_of_variances = archive.integer("has_variances", 0, of_another);
  const bool has_variances = kind_of_variances > 0;
  const bool is_mean = std::abs(weights.sum() - 1) < 1e-6;
  if (weights.size() == 0 || weights.size() > most_averaged || !(weights.minCoeff() > 0) ||
      !(is_mean || !has_variances))
    archive.fail("the weights are damaged");
  std::vector<std::shared_ptr<const Field<Dim>>> fields, variances;
  const auto read = [&](const std::string& name) {
    const Archive part = archive.part(name);
    if (part.kind == average_kind) archive.fail("an average is inside another one");
    return from_archive(part);
  };
  for (Index i = 0; i < weights.size(); ++i) {
    fields.push_back(read("field" + std::to_string(i)));
    if (has_variances) variances.push_back(read("variance" + std::to_string(i)));
  }
  const auto other = kind_of_variances == of_another ? read("other") : nullptr;
  return std::make_shared<const AverageField<Dim>>(
      std::move(fields), std::vector<double>(weights.begin(), weights.end()), std::move(variances), other);
}

#define CSRBF_INSTANTIATE(Dim)                                                                \
  template Archive average_to_archive<Dim>(const AverageField<Dim>&,                          \
                                           const std::function<Archive(const Field<Dim>&)>&); \
  template std::shared_ptr<const Field<Dim>> average_from<Dim>(                               \
      const Archive&, const std::function<std::shared_ptr<const Field<Dim>>(const Archive&)>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
