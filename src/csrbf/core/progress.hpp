#pragma once

#include "csrbf/core/error.hpp"

#include <functional>
#include <string_view>

namespace csrbf {

/// Called from time to time during long computations, always on the calling thread, with the name of the stage and the
/// fraction done in [0, 1]. Return false to stop: the computation throws Cancelled.
using Progress = std::function<bool(std::string_view stage, double fraction)>;

/// Reports to `progress` when it is set; throws Cancelled when it returns false.
inline void report(const Progress& progress, std::string_view stage, double fraction) {
  if (progress && !progress(stage, fraction)) throw Cancelled();
}

}  // namespace csrbf
