#pragma once

#include <string_view>
#include <vector>

namespace csrbf {

struct MethodFit;
struct MethodOptions;
struct PreparedCloud;

/// A way to make an implicit surface of a cloud, other than the composite one.
struct SurfaceMethod {
  const char* name;
  const char* what;  ///< in a few words, with its source
  bool has_model;    ///< whether write_model() knows its fields
  bool has_budget;   ///< whether it takes the option `centers`
  bool smooths;      ///< whether it takes the option `smoothing`
  MethodFit (*fit)(const PreparedCloud& cloud, const MethodOptions& options);
};

/// All of them; reconstruct() takes their names.
const std::vector<SurfaceMethod>& surface_methods();

/// The method of that name, or null.
const SurfaceMethod* find_surface_method(std::string_view name);

}  // namespace csrbf
