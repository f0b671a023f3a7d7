#pragma once

#include "commands/mesh_summary.hpp"

#include "csrbf/surface/reconstruct.hpp"

namespace csrbf::app {

ReconstructOptions make_reconstruct_options(const ReconstructCommand& command, Session& session);

/// What the report and the summary say about a surface.
void add_report(const ReconstructReport& report, Session& session);
void say_quality(const ReconstructReport& report, Session& session);

/// Is the command to work tile by tile?
bool works_in_tiles(const ReconstructCommand& command);
void run_in_tiles(const ReconstructCommand& command, Session& session);

}  // namespace csrbf::app
