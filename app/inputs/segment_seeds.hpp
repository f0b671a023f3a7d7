#pragma once

#include "common.hpp"

#include "csrbf/core/grid.hpp"
#include "csrbf/levelset/segment_options.hpp"

namespace csrbf::app {

/// Refuses an image of the size of another one, such as its mask, that lies elsewhere in the space of the patient. One
/// without such a space, as of .npy, is taken voxel by voxel.
void require_same_place(const std::string& flag, const std::string& path, const Grid& given, const Grid& image);

/// Sets the seeds of --seeds FILE, an image of labels or a table of points with labels: 1 marks label 0 of the result,
/// 2 label 1, and so on; 0 elsewhere. Their confidences are those of the table, if it has them, else of
/// --seed-confidence P|FILE. Throws UsageError for other numbers, another size and points outside, IoError.
template <int Dim>
void read_seeds(const std::string& path, const std::string& confidence, const Grid& grid, SegmentOptions& options);

/// What an image covers: "x from 0 to 99, y from 0 to 49".
template <int Dim>
std::string extent_text(const Grid& grid);

}  // namespace csrbf::app
