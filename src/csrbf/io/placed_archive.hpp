#pragma once

#include "csrbf/io/archive.hpp"
#include "csrbf/surface/placed_field.hpp"

#include <memory>

namespace csrbf {

/// The kind of the archive of a PlacedField.
inline constexpr const char* placed_kind = "placed surface";

/// Converts a placed field, with its inner field, to an archive and back. Throws InvalidInput for a kind of field that
/// has no file form; reading throws IoError or InvalidInput for missing or inconsistent entries.
Archive to_archive(const PlacedField& field);
std::shared_ptr<const PlacedField> placed_from(const Archive& archive);

}  // namespace csrbf
