#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/surface/prepare.hpp"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// A way to make an implicit surface of a cloud, other than the composite one.
struct SurfaceMethod {
  const char* name;
  const char* what;  ///< in a few words, with its source
  bool has_model;    ///< whether write_model() knows its fields
  MethodFit (*fit)(const PreparedCloud& cloud, const MethodOptions& options);
};

/// All of them; reconstruct() takes their names.
const std::vector<SurfaceMethod>& surface_methods();

/// The method of that name, or null.
const SurfaceMethod* find_surface_method(std::string_view name);

}  // namespace csrbf
