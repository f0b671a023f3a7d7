#pragma once

#include "answer.hpp"

#include "csrbf/approx/function.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/core/mesh.hpp"

#include <memory>
#include <optional>

namespace csrbf::wasm {

/// What JavaScript holds by its address: a fitted function, or a surface with the points that it was made from.
struct Model {
  std::optional<NamedFunction> function;
  std::shared_ptr<const Field<3>> surface;  ///< also of functions of three variables with one value
  Points<3> points{3, 0};                   ///< that a mesh is checked against
  Points<3> normals{3, 0};
};

/// Adds the model to the answer, which says its address and what it is. JavaScript owns it.
void add_model(Answer& answer, Model model);

/// positions, triangles and normals.
void add_mesh(Answer& answer, Mesh mesh);

}  // namespace csrbf::wasm
