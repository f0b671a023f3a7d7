#pragma once

#include "csrbf/implicit/combine/transformed_field.hpp"
#include "csrbf/io/models/archive.hpp"
#include "csrbf/surface/composite/composite_field.hpp"
#include "csrbf/surface/winding/winding_number.hpp"

namespace csrbf {

inline constexpr const char* composite_kind = "composite surface";

/// Converts a composite field to an archive and back: to the same values, bit for bit. Throws IoError for missing or
/// inconsistent entries.
Archive to_archive(const CompositeField& field);
std::shared_ptr<const CompositeField> composite_from(const Archive& archive);

/// The kind of the archive of a TransformedField.
inline constexpr const char* transformed_kind = "placed surface";

/// Converts a transformed field, with its inner field, to an archive and back. Throws InvalidInput for a kind of field
/// that has no file form; reading throws IoError or InvalidInput for missing or inconsistent entries.
Archive to_archive(const TransformedField& field);
std::shared_ptr<const TransformedField> transformed_from(const Archive& archive);

/// Converts a winding number to an archive and back. Reading throws IoError for missing or inconsistent entries.
Archive to_archive(const WindingNumber& winding);
WindingNumber winding_from(const Archive& archive);

}  // namespace csrbf
