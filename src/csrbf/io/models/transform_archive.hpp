#pragma once

#include "csrbf/approx/transform/transformed_back.hpp"
#include "csrbf/io/models/archive.hpp"

#include <functional>
#include <memory>

namespace csrbf {

inline constexpr const char* transformed_back_kind = "transformed back";

/// The file form of values that were fitted as roots or logarithms; the functions given write and read their fields.
template <int Dim>
Archive transform_to_archive(const TransformedBack<Dim>& field,
                             const std::function<Archive(const Field<Dim>&)>& to_archive);

template <int Dim>
std::shared_ptr<const Field<Dim>> transform_from(
    const Archive& archive, const std::function<std::shared_ptr<const Field<Dim>>(const Archive&)>& from_archive);

}  // namespace csrbf
