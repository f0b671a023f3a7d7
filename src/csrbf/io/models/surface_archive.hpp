#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/io/models/archive.hpp"

#include <memory>

namespace csrbf {

/// The archive of an implicit surface: a composite or transformed field, a fitted function, or solids combined from
/// these. Throws InvalidInput for a kind of field that has no file form.
Archive surface_to_archive(const Field<3>& field);

/// Reads an archive from surface_to_archive(): the field gives the same values, bit for bit. Throws IoError for missing
/// or inconsistent entries.
std::shared_ptr<const Field<3>> surface_from(const Archive& archive);

}  // namespace csrbf
