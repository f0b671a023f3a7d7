#pragma once

#include "csrbf/io/models/archive.hpp"
#include "csrbf/surface/composite/composite_field.hpp"

#include <memory>

namespace csrbf {

inline constexpr const char* composite_kind = "composite surface";

/// Converts a composite field to an archive and back: to the same values, bit for bit. Throws IoError for missing or
/// inconsistent entries.
Archive to_archive(const CompositeField& field);
std::shared_ptr<const CompositeField> composite_from(const Archive& archive);

}  // namespace csrbf
