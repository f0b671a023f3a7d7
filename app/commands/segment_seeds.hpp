#pragma once

#include "commands/commands.hpp"

#include "csrbf/levelset/segment_options.hpp"

namespace csrbf::app {

/// Sets the seeds of --seeds FILE, an image of labels or a table of points with labels: 1 marks label 0 of the result,
/// 2 label 1, and so on; 0 elsewhere. Their confidences are those of the table, if it has them, else of
/// --seed-confidence P|FILE. Throws UsageError for other numbers, another size and points outside, IoError.
template <int Dim>
void read_seeds(const SegmentCommand& command, const Grid& grid, SegmentOptions& options);

}  // namespace csrbf::app
