#pragma once

#include "csrbf/approx/samples/average_field.hpp"
#include "csrbf/io/models/archive.hpp"

#include <functional>
#include <memory>

namespace csrbf {

inline constexpr const char* average_kind = "average of fields";

/// The file form of an average, whose parts are written and read by the functions given.
template <int Dim>
Archive average_to_archive(const AverageField<Dim>& field, const std::function<Archive(const Field<Dim>&)>& to_archive);

template <int Dim>
std::shared_ptr<const Field<Dim>> average_from(
    const Archive& archive, const std::function<std::shared_ptr<const Field<Dim>>(const Archive&)>& from_archive);

}  // namespace csrbf
