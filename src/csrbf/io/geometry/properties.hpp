#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/io/files/bytes.hpp"

namespace csrbf {

/// Types of properties.
inline constexpr TypeName property_types[] = {
    {"char", SampleType::int8},     {"uchar", SampleType::uint8},    {"short", SampleType::int16},
    {"ushort", SampleType::uint16}, {"int", SampleType::int32},      {"uint", SampleType::uint32},
    {"float", SampleType::float32}, {"double", SampleType::float64},
};

/// Throws InvalidInput in the name of `function` unless every property has one value per point or vertex.
void check_properties(const std::vector<Property>& properties, Index points, const char* function);

/// The properties red, green and blue of points or vertices, if they have them. Refers to the searched list.
struct ColorColumns {
  const Property* red = nullptr;
  const Property* green = nullptr;
  const Property* blue = nullptr;
  double scale = 1;  ///< of components to [0, 255]

  [[nodiscard]] bool complete() const { return red != nullptr && green != nullptr && blue != nullptr; }
  /// Colour of point i, each component in [0, 255].
  [[nodiscard]] Point<3> rgb(Index i) const;
  /// Colour of point i, each component in [0, 1] and rounded to a multiple of 0.0001, which preserves 8 bits.
  [[nodiscard]] Point<3> unit_rgb(Index i) const;
};

ColorColumns find_colors(const std::vector<Property>& properties);

/// Gives coordinates, normals and colours in the usual spellings (X, normal_x, NormalX, r, diffuse_red) the names that
/// they have here, where all three are there.
void standardize_names(std::vector<std::string>& names);

/// Adds red, green and blue (uchar) from three rows of components: in [0, 1], in [0, 255] when one is above 1, or of 16
/// bits when one is above 255.
void add_colors(const Eigen::Ref<const Eigen::MatrixXd>& parts, std::vector<Property>& properties);

/// True when all entries are whole numbers in [0, 65535] and one is above 1: colours, not normals.
bool are_whole_colors(const Eigen::Ref<const Eigen::MatrixXd>& parts);

/// The largest change of a coordinate by rounding to float32, when it exceeds a millionth of the diagonal of the
/// bounding box (infinite beyond the range of float32); 0 when float32 suffices. Non-finite coordinates are ignored.
/// O(n).
double float_coordinate_loss(const PointsRef<3>& points);

}  // namespace csrbf
