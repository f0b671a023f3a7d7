#pragma once

#include "csrbf/approx/samples/fitted_field.hpp"
#include "csrbf/io/models/archive.hpp"

namespace csrbf {

/// The kind of the archives of fitted fields.
inline constexpr const char* fitted_kind = "fitted field";

/// The archive of a fitted field without the inner field, and back. Reading throws IoError.
template <int Dim>
Archive frame_to_archive(const typename FittedField<Dim>::Frame& frame);
template <int Dim>
typename FittedField<Dim>::Frame frame_from(const Archive& archive);

}  // namespace csrbf
