#pragma once

#include "csrbf/approx/function.hpp"

#include <string>
#include <vector>

namespace csrbf {

/// A fitted function and the column names of its samples.
struct NamedFunction {
  Function function;
  std::vector<std::string> coordinate_names = {};  ///< empty: x y z, or x1 x2 ... from four on
  std::vector<std::string> value_names = {};       ///< empty: value, or value1 value2 ...
};

}  // namespace csrbf
