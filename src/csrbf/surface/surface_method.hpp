#pragma once

#include <string_view>
#include <vector>

namespace csrbf {

struct MethodFit;
struct MethodOptions;
struct PreparedCloud;

/// A method that makes an implicit surface from points, other than the composite one.
struct SurfaceMethod {
  const char* name;
  const char* what;  ///< what it does, in a few words, with the source
  bool has_model;    ///< whether write_model() can write its surfaces
  bool has_budget;   ///< whether it takes the option `centers`
  bool smooths;      ///< whether it takes the option `smoothing`
  MethodFit (*fit)(const PreparedCloud& cloud, const MethodOptions& options);
};

/// All such methods; reconstruct() takes their names.
const std::vector<SurfaceMethod>& surface_methods();

/// The method with this name, or null.
const SurfaceMethod* find_surface_method(std::string_view name);

}  // namespace csrbf
