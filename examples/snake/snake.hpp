#pragma once

#include "csrbf/core/types.hpp"

#include <functional>
#include <vector>

/// A snake (Kass, Witkin and Terzopoulos 1988): a closed polygon that minimises
///
///     1/2 int (tension |x'|^2 + stiffness |x''|^2) ds + what the picture adds,
///
/// the Lagrangian way of eq. (7.1). Each step is implicit in the internal forces, a cyclic matrix of five diagonals,
/// and explicit in those of the picture; then the points are spread evenly again. It has one part and no holes, ever.
struct SnakeOptions {
  double tension = 0.05, stiffness = 0.05;
  double step = 0.5;     ///< of the points per iteration, in pixels for forces of size 1
  double spacing = 1.5;  ///< of the points, in pixels
  int iterations = 1000;
};

using Polygon = csrbf::Points<2>;  ///< closed, counter-clockwise (with y upwards)

/// Writes the force of the picture on each point; `normals` point outwards.
using SnakeForce = std::function<void(const Polygon& points, const Polygon& normals, Polygon& force)>;

Polygon circle(const csrbf::Point<2>& center, double radius);

Polygon move_snake(Polygon points, const SnakeForce& force, const SnakeOptions& options = {});

/// 1 for the pixels of an n x n picture whose centres are inside, by the even-odd rule.
std::vector<unsigned char> fill(const Polygon& points, csrbf::Index n);
