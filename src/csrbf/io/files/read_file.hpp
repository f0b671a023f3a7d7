#pragma once

#include <string>

namespace csrbf {

/// The whole content of a file; "-" is standard input. Throws IoError with the file and the system's reason.
std::string read_file(const std::string& path);

/// The name of an input in messages: the path, or "standard input" for "-".
std::string display_name(const std::string& path);

/// The file name from its last dot on, in lower case: ".ply"; empty when there is none.
std::string file_extension(const std::string& path);

}  // namespace csrbf
