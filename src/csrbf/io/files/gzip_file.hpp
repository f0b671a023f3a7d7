#pragma once

#include <string>
#include <string_view>

namespace csrbf {

// Files that may be compressed by gzip, as a whole: "soundings.csv.gz".

/// file_extension() of what the file holds: ".csv".
std::string content_extension(const std::string& path);

/// read_file(), decompressed when the bytes are those of a gzip file, whatever its name.
std::string read_content(const std::string& path);

/// What a file holds, and in which format.
struct Content {
  std::string extension;  ///< ".csv"
  std::string bytes;      ///< decompressed
};

/// The content of a file that has one of the `known` (blank-separated) formats, by its extension or, where it has none,
/// by how its bytes begin; text without a mark counts as `text` (".csv"). Throws IoError for other formats, with their
/// list after `kinds` ("point files").
Content read_with_format(const std::string& path, const std::string& known, const std::string& text,
                         const std::string& kinds);

/// write_file(), compressed when the name ends with ".gz".
void write_content(const std::string& path, std::string_view bytes);

}  // namespace csrbf
