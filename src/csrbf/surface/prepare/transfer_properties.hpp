#pragma once

#include "csrbf/core/mesh.hpp"

namespace csrbf {

/// Transfers properties of samples (3 x n) to other points (3 x m), such as the vertices of a mesh made from them.
/// Colours (red green blue alpha of type uchar) become the mean of the four nearest samples, weighted by inverse
/// distance; all other properties are those of the nearest sample. Samples whose coordinates are not finite are
/// ignored. Results do not depend on position, rotation and scale. O((n + m) log n), in parallel. Throws InvalidInput
/// if a property does not have one value per sample or if no sample is finite.
std::vector<Property> transfer_properties(const PointsRef<3>& samples, const std::vector<Property>& properties,
                                          const PointsRef<3>& targets);

}  // namespace csrbf
