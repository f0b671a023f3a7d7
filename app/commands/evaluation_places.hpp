#pragma once

#include "commands/commands.hpp"

#include "csrbf/io/model.hpp"

#include <functional>

namespace csrbf::app {

/// Where a function is evaluated: at points, or at the nodes of a grid.
struct Places {
  Index count = 0;
  std::function<Eigen::MatrixXd(Index begin, Index n)> points;  ///< d x n
  std::vector<Eigen::VectorXd> axes = {};  ///< coordinates along each axis where the places are an axis-aligned grid
  bool is_image = false;                   ///< the result is an image with this layout
  VolumeLayout layout = {};                ///< one voxel per place
  Json options = Json::object();           ///< of the report
};

/// Throws UsageError unless the flags say where to evaluate, and the output can hold it.
void check_places(const EvaluateCommand& command);

/// Reads or makes the places. Throws UsageError, IoError.
Places make_places(const EvaluateCommand& command, const NamedFunction& model);

}  // namespace csrbf::app
