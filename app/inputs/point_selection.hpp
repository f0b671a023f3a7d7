#pragma once

#include "session.hpp"

#include "csrbf/core/mesh.hpp"
#include "csrbf/io/points.hpp"

namespace csrbf::app {

/// Which points of a scanner to use.
struct PointFlags {
  std::string classes;
  std::string returns = "all";
};

/// The points that the flags ask for. Throws UsageError.
PointSelection make_selection(const PointFlags& flags);

/// The vertices of what was read. Warns of a first column that numbers the rows.
PointCloud vertices_of(Mesh&& mesh, Session& session);

}  // namespace csrbf::app
