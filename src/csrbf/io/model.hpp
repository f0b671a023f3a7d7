#pragma once

#include "csrbf/core/field.hpp"

#include <memory>
#include <string>

namespace csrbf {

/// Writes a field to a .csrbf file, complete: read_model() gives the same values. Throws InvalidInput for a kind of
/// field that has no file form, IoError when the file cannot be written.
void write_model(const std::string& path, const Field<3>& field);

/// Reads what write_model() wrote. Throws IoError for files that are missing, damaged, of another kind or from the
/// future.
std::shared_ptr<const Field<3>> read_model(const std::string& path);

}  // namespace csrbf
