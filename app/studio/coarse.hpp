#pragma once

#include <filesystem>
#include <string>

namespace csrbf::app {

/// Writes a coarse copy of an input into `folder`, unless a newer one is there, and returns its name: some thousand
/// points or rows, some ten thousand voxels with wider spacing. What cannot be made coarse (models) becomes a link.
/// Commands on copies are quick enough to be run while somebody moves a slider. Throws IoError.
std::string coarse_copy(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace csrbf::app
