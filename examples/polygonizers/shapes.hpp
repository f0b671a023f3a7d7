#pragma once

#include "csrbf/core/field.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

/// A solid to polygonize and what is known about its surface.
struct Shape {
  std::string name;
  std::shared_ptr<const csrbf::Field<3>> field;
  std::optional<csrbf::Index> euler;  ///< its Euler characteristic; none where it depends on the cells
};

/// A torus, a double torus, three balls that touch, a shell two cells thick, and a box with sharp edges.
std::vector<Shape> make_shapes(int resolution);
