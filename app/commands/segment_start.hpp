#pragma once

#include "session.hpp"

#include "csrbf/levelset/seed.hpp"

namespace csrbf::app {

/// The voxels that --init WHERE covers; none for auto. Throws UsageError for other forms and for places outside the
/// image, IoError for files.
template <int Dim>
Seed read_seed(const std::string& where, const Grid& grid, const Progress& progress);

/// The voxels of --mask FILE. Throws UsageError when it has another size, IoError.
std::vector<std::uint8_t> read_voxels(const std::string& flag, const std::string& path, const Grid& grid);

}  // namespace csrbf::app
