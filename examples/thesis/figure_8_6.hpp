#pragma once

#include "figure.hpp"
#include "level_sets.hpp"

namespace csrbf::thesis {

/// About as many nodes on pixels of the image, the denser the closer to the border of the labels of a shape that is
/// known before: farther from it than `width` pixels they are `ratio` times farther apart (Fig. 8.7).
Nodes<2> nodes_along(const Grid& grid, const std::vector<std::uint8_t>& shape, Index count, double ratio, double width);

/// Nodes on a lattice of equilateral triangles (Fig. 8.1 b), about as many.
Nodes<2> triangular_nodes(const Grid& grid, Index count);

/// The star of Fig. 8.6 by collocation at these nodes, from a disc that holds its middle.
SegmentedImage star_run(const Phantom& star, const Nodes<2>& nodes, double rho);

/// Figs. 8.6 and 8.7.
Figure figure_8_6();

}  // namespace csrbf::thesis
