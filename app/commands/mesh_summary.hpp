#pragma once

#include "commands/commands.hpp"

#include "csrbf/core/mesh.hpp"
#include "csrbf/implicit/polygonize.hpp"

namespace csrbf::app {

/// Fails early when the mesh could not be written: throws UsageError for an unknown format, WriteFailure otherwise.
void expect_mesh_output(const std::string& path, Session& session);

/// Adds size and topology of a mesh to result and summary.
void add_mesh_summary(const std::string& path, const Mesh& mesh, Session& session);
void add_mesh_summary(const std::string& path, const Topology& topology, Session& session);

/// Adds the number of bridges and holes that the mesh was made without.
void add_weak_features(Index count, Session& session);

}  // namespace csrbf::app
