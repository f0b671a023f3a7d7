#pragma once

#include "csrbf/io/models/archive.hpp"
#include "csrbf/surface/winding/winding_number.hpp"

namespace csrbf {

/// The archive of a winding number, and back. Reading throws IoError for entries that are missing or do not fit
/// together.
Archive to_archive(const WindingNumber& winding);
WindingNumber winding_from(const Archive& archive);

}  // namespace csrbf
