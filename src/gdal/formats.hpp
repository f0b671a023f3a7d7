#pragma once

#include <string>

#include <gdal.h>

namespace csrbf {

std::string extension_of(const std::string& path);

/// What writes files with this extension; null where this GDAL has nothing that does.
GDALDriverH driver_of(const std::string& path);

/// Drivers do not tell of all that they could not write, as on a full disk, least of all when they close a file: what
/// was written is read again.
inline constexpr const char* incomplete =
    "the file could not be written in full, as when no space is left on the device";

}  // namespace csrbf
