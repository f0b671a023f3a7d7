#include "csrbf/io/model.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/archive.hpp"
#include "csrbf/io/function_archive.hpp"
#include "csrbf/io/surface_archive.hpp"

#include <utility>

namespace csrbf {

void write_model(const std::string& path, const Field<3>& field) {
  write_archive(path, surface_to_archive(field));
}

std::shared_ptr<const Field<3>> read_model(const std::string& path) {
  const Archive archive = read_archive(path);
  if (archive.kind != function_kind) return surface_from(archive);
  const Function function = function_from(archive).function;
  if (function.dimension() != 3 || function.components() != 1)
    archive.fail("this is a function of " + std::to_string(function.dimension()) + " variables with " +
                 std::to_string(function.components()) +
                 " components, not a surface: surfaces are functions of 3 variables with 1 component");
  return std::get<Fit<3>>(function.fits()).components.front();
}

void write_model(const std::string& path, const NamedFunction& function) {
  write_archive(path, to_archive(function));
}

NamedFunction read_function(const std::string& path) {
  return function_from(read_archive(path));
}

}  // namespace csrbf
