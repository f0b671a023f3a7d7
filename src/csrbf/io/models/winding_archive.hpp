#pragma once

#include "csrbf/io/models/archive.hpp"
#include "csrbf/surface/winding/winding_number.hpp"

namespace csrbf {

/// Converts a winding number to an archive and back. Reading throws IoError for missing or inconsistent entries.
Archive to_archive(const WindingNumber& winding);
WindingNumber winding_from(const Archive& archive);

}  // namespace csrbf
