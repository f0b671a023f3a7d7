#pragma once

#include "csrbf/surface/composite/composite_field.hpp"

#include <string>

namespace csrbf {

/// Writes a field as it is in memory, for the same program on the same kind of machine: without copies, so that tiles
/// take little memory. Complete or not at all (AtomicFile). Throws IoError.
void write_field(const std::string& path, const CompositeField& field);

/// Reads it again; evaluates to the same bits. Throws IoError for files that are missing or incomplete.
std::shared_ptr<const CompositeField> read_field(const std::string& path);

}  // namespace csrbf
