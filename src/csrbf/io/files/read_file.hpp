#pragma once

#include <string>
#include <string_view>

namespace csrbf {

/// The whole content of a file; "-" is standard input. Throws IoError with the file and the system's reason.
std::string read_file(const std::string& path);

/// The name of an input in messages: the path, or "standard input" for "-".
std::string display_name(const std::string& path);

/// The file name from its last dot on, in lower case: ".ply"; empty when there is none, unless assume_format() said
/// what the file counts as.
std::string file_extension(const std::string& path);

/// Is the extension one of the blank-separated list?
bool is_listed(std::string_view extension, std::string_view list);

/// Throws IoError "path: unknown extension ...; `what`": what says which there are.
[[noreturn]] void refuse_extension(const std::string& path, const std::string& extension, const std::string& what);

}  // namespace csrbf
