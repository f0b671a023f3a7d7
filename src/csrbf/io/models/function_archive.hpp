#pragma once

#include "csrbf/approx/function.hpp"
#include "csrbf/io/models/archive.hpp"

namespace csrbf {

/// The kind of archives of functions.
inline constexpr const char* function_kind = "function";

/// Texts, each an entry of its own: "names" says how many, "name0" is the first. Reading throws IoError.
void set_texts(Archive& archive, const std::string& name, const std::vector<std::string>& texts);
std::vector<std::string> texts_of(const Archive& archive, const std::string& name);

/// A report, but for the times. Reading throws IoError.
Archive report_to_archive(const FitReport& report);
FitReport report_from(const Archive& archive);

/// Throws InvalidInput for fields that have no file form, and when numbers of names do not match.
Archive to_archive(const NamedFunction& function);

/// Throws IoError unless it is a complete archive of a function.
NamedFunction function_from(const Archive& archive);

}  // namespace csrbf
