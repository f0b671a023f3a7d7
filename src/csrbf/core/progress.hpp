#pragma once

#include "csrbf/core/error.hpp"

#include <functional>
#include <string_view>

namespace csrbf {

/// Called now and then during long work, always from the calling thread, with the stage's name and the fraction done
/// in [0, 1]. Return false to stop: the work ends with Cancelled.
using Progress = std::function<bool(std::string_view stage, double fraction)>;

/// Reports to `progress` when it is set; throws Cancelled when it returns false.
inline void report(const Progress& progress, std::string_view stage, double fraction) {
  if (progress && !progress(stage, fraction)) throw Cancelled();
}

}  // namespace csrbf
