#include "inputs/point_selection.hpp"

#include <cmath>

namespace csrbf::app {

PointSelection make_selection(const PointFlags& flags) {
  PointSelection selection;
  selection.returns = flags.returns;
  if (flags.classes.empty()) return selection;
  constexpr double most = 255;
  for (const double number : parse_list(flags.classes, ',', "--class")) {
    if (!(number >= 0 && number <= most && number == std::floor(number)))
      throw UsageError("--class " + flags.classes + ": classes are whole numbers from 0 to 255");
    selection.classes.push_back(static_cast<int>(number));
  }
  return selection;
}

}  // namespace csrbf::app
