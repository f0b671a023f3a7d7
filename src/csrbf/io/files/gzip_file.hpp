#pragma once

#include <string>
#include <string_view>

namespace csrbf {

// Files that may be compressed by gzip, as a whole: "soundings.csv.gz".

/// file_extension() of what the file holds: ".csv".
std::string content_extension(const std::string& path);

/// read_file(), decompressed when the bytes are those of a gzip file, whatever its name.
std::string read_content(const std::string& path);

/// write_file(), compressed when the name ends with ".gz".
void write_content(const std::string& path, std::string_view bytes);

}  // namespace csrbf
