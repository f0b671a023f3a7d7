#pragma once

#include "csrbf/surface/composite/composite.hpp"

#include <span>

namespace csrbf {

/// Groups samples `ids` of a cloud, close together, by the smooth sheet that they lie on: from sample to sample, the
/// normals turn little and the way runs along the surface. Sheets that continue each other across a gap are one. Those
/// within 78 degrees of `normal` are never grouped with the others. Groups in the order of their first sample; none has
/// fewer than `least` samples: those of smaller ones are left out. The samples may be thinned: then their distances are
/// `stretch` times the spacing. O(n^(3/2)).
std::vector<std::vector<Index>> split_samples(const OrientedPoints& cloud, std::span<const Index> ids,
                                              const Point<3>& normal, double stretch, Index least);

/// Least cosine between the normals of samples of a piece and its own: 78 degrees. Larger: loses creases, smaller:
/// joins thin sheets. Chosen by hand.
inline constexpr double compatible_normals = 0.2;

}  // namespace csrbf
