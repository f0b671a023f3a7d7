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
  bool rows_turn = false;                  ///< the second of `axes` ascends, the rows of the image descend
  bool is_image = false;                   ///< the result is an image with this layout
  VolumeLayout layout = {};                ///< one voxel per place
  std::string crs = {};                    ///< reference system of the places
  Json options = Json::object();           ///< of the report
};

/// The value of --grid without one.
inline constexpr const char* grid_without_numbers = "auto";

/// The value of --levels without one.
inline constexpr const char* about_ten_levels = "auto";

/// Throws UsageError unless the flags of a grid go together.
void check_grid(const EvaluateCommand& command);

/// Throws UsageError unless the flags say where to evaluate, and the output can hold it.
void check_places(const EvaluateCommand& command);

/// Reads or makes the places, and warns of columns of other names. Throws UsageError, IoError.
Places make_places(const EvaluateCommand& command, const NamedFunction& model, Session& session);

}  // namespace csrbf::app
