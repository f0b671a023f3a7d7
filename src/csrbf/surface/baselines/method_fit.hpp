#pragma once

#include "csrbf/surface/prepare/prepare.hpp"

namespace csrbf {

/// What every method understands in its own way; see ReconstructOptions.
struct MethodOptions {
  Index centers = 0;                     ///< 0: the default of the method
  std::optional<double> smoothing = {};  ///< not set: chosen from the data
  Progress progress = {};
};

/// What a method made of a cloud.
struct MethodFit {
  std::shared_ptr<const Field<3>> field;  ///< in the unit coordinates of the cloud
  Index centers = 0;                      ///< basis functions, or whatever the method counts
  double smoothing = 0;                   ///< used or chosen
};

}  // namespace csrbf
