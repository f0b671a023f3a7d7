#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/io/models/archive.hpp"

#include <memory>

namespace csrbf {

/// The archive of an implicit surface: a composite or transformed field, a fitted function, or solids combined from
/// such. Throws InvalidInput for a kind of field that has no file form.
Archive surface_to_archive(const Field<3>& field);

/// Reads what surface_to_archive() made: the field gives the same values, bit for bit. Throws IoError for entries that
/// are missing or do not fit together.
std::shared_ptr<const Field<3>> surface_from(const Archive& archive);

}  // namespace csrbf
