#pragma once

#include "csrbf/implicit/combine/transformed_field.hpp"
#include "csrbf/io/models/archive.hpp"

#include <memory>

namespace csrbf {

/// The kind of the archive of a TransformedField.
inline constexpr const char* transformed_kind = "placed surface";

/// Converts a transformed field, with its inner field, to an archive and back. Throws InvalidInput for a kind of field
/// that has no file form; reading throws IoError or InvalidInput for missing or inconsistent entries.
Archive to_archive(const TransformedField& field);
std::shared_ptr<const TransformedField> transformed_from(const Archive& archive);

}  // namespace csrbf
