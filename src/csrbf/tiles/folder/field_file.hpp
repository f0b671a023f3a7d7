#pragma once

#include "csrbf/surface/composite/composite_field.hpp"

#include <string>

namespace csrbf {

/// How patches are written: as they are, or, in half the bytes, in single precision but for their places, which moves
/// the surface by less than a millionth of a patch.
enum class FieldNumbers : std::int64_t { exact, rounded };

/// Writes a field for the same program on the same kind of machine: without copies, so that tiles take little memory,
/// and without the exact samples of the winding number, which evaluation does not need. Complete or not at all
/// (AtomicFile). Throws IoError.
void write_field(const std::string& path, const CompositeField& field, FieldNumbers numbers);

/// Reads it again; exact numbers evaluate to the same bits. Throws IoError for files that are missing or incomplete.
std::shared_ptr<const CompositeField> read_field(const std::string& path);

}  // namespace csrbf
