#pragma once

#include "csrbf/io/models/archive.hpp"
#include "csrbf/io/named_function.hpp"

namespace csrbf {

/// The kind of archives of functions.
inline constexpr const char* function_kind = "function";

/// Throws InvalidInput for fields that have no file form, and when numbers of names do not match.
Archive to_archive(const NamedFunction& function);

/// Throws IoError unless it is a complete archive of a function.
NamedFunction function_from(const Archive& archive);

}  // namespace csrbf
