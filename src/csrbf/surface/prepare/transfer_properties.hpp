#pragma once

#include "csrbf/core/mesh.hpp"

namespace csrbf {

/// Transfers properties of samples to other points, such as the vertices of a mesh made from them: colours (red green
/// blue alpha of type uchar) become the mean of the four nearest samples, weighted by inverse distance; everything else
/// is taken from the nearest sample. Samples whose coordinates are not finite are left out. Results do not depend on
/// position, rotation and scale. O((n + m) log n), in parallel.
/// Throws InvalidInput if a property does not have one value per sample, or if no sample is finite.
std::vector<Property> transfer_properties(const PointsRef<3>& samples, const std::vector<Property>& properties,
                                          const PointsRef<3>& targets);

}  // namespace csrbf
