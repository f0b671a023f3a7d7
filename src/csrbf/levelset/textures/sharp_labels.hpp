#pragma once

#include "csrbf/levelset/partition/partition.hpp"

namespace csrbf {

/// Prices of independent voxels take structures within regions for borders, and means that vary follow them. Where
/// borders are sharp, what neighbours do not predict (NeighbourCode) says better which labels the image has. So of two
/// regions, those of the models not chosen are compared by that price, too, about a constant, a quadratic or a smooth
/// mean for each region; the best of those with sharp borders are followed to their end, and taken where they tell
/// clearly more than `found`, and than one region. Nothing changes with seeds or a grain.
void prefer_sharp_labels(PartitionPrice& price, Partition& found, const Progress& progress = {});

}  // namespace csrbf
