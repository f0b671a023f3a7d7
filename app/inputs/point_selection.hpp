#pragma once

#include "common.hpp"

#include "csrbf/io/points.hpp"

namespace csrbf::app {

/// Which points of a scanner to use.
struct PointFlags {
  std::string classes;
  std::string returns = "all";
};

/// The points that the flags ask for. Throws UsageError.
PointSelection make_selection(const PointFlags& flags);

}  // namespace csrbf::app
