#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace csrbf {

struct ZipEntry {
  std::string name;
  std::string_view content;
};

/// The bytes of a zip archive with these files, compressed. Throws IoError beyond 4 GB, which its fields cannot count.
std::string zip_archive(const std::vector<ZipEntry>& entries, const std::string& name);

}  // namespace csrbf
