#pragma once

#include "session.hpp"

#include "csrbf/io/samples.hpp"

namespace csrbf::app {

/// A reference system in a few words: EPSG:32633, or its name.
std::string short_crs(const std::string& crs);

/// Describes a table of samples: its columns with their ranges, and what csrbf fit would take for coordinates and
/// values.
void report_table(const SampleSource& source, Session& session);

}  // namespace csrbf::app
