#pragma once

#include "csrbf/approx/function.hpp"
#include "csrbf/io/models/archive.hpp"

namespace csrbf {

/// The kind of archives of functions.
inline constexpr const char* function_kind = "function";

/// Throws InvalidInput for fields that have no file form, and when numbers of names do not match.
Archive to_archive(const NamedFunction& function);

/// Throws IoError unless it is a complete archive of a function.
NamedFunction function_from(const Archive& archive);

}  // namespace csrbf
