#pragma once

#include "commands/evaluate/places.hpp"

namespace csrbf::app {

/// Throws UsageError unless the flags go with --levels; makes a grid where none is given.
void check_levels(EvaluateCommand& command);

/// Writes contour lines of the function, found on the grid.
void write_levels(const EvaluateCommand& command, const NamedFunction& model, const Places& places, Session& session);

}  // namespace csrbf::app
