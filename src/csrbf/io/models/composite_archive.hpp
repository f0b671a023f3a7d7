#pragma once

#include "csrbf/io/models/archive.hpp"
#include "csrbf/surface/composite/composite_field.hpp"

#include <memory>

namespace csrbf {

inline constexpr const char* composite_kind = "composite surface";

/// The archive of a composite field, and back: the same values, bit for bit. Throws IoError for entries that are
/// missing or do not fit together.
Archive to_archive(const CompositeField& field);
std::shared_ptr<const CompositeField> composite_from(const Archive& archive);

}  // namespace csrbf
