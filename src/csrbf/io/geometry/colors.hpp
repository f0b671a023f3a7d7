#pragma once

#include "csrbf/core/mesh.hpp"

namespace csrbf {

/// The properties red, green and blue of points or vertices, if they have them. Refers to the searched list.
struct ColorColumns {
  const Property* red = nullptr;
  const Property* green = nullptr;
  const Property* blue = nullptr;

  [[nodiscard]] bool complete() const { return red != nullptr && green != nullptr && blue != nullptr; }
  /// Colour of point i, each component in [0, 255].
  [[nodiscard]] Point<3> rgb(Index i) const;
  /// Colour of point i, each component in [0, 1] and rounded to a multiple of 0.0001, which preserves 8 bits.
  [[nodiscard]] Point<3> unit_rgb(Index i) const;
};

ColorColumns find_colors(const std::vector<Property>& properties);

/// Adds red, green and blue (uchar) from three rows of components: in [0, 1], or in [0, 255] when one is above 1.
void add_colors(const Eigen::Ref<const Eigen::MatrixXd>& parts, std::vector<Property>& properties);

/// True when all entries are whole numbers in [0, 255] and one is above 1: 8-bit colours, not normals.
bool are_byte_colors(const Eigen::Ref<const Eigen::MatrixXd>& parts);

}  // namespace csrbf
