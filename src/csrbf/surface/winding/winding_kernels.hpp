#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/surface/winding/winding_tree.hpp"

/// The inner loops of WindingNumber. Internal. All lengths are in units of the tree, relative to its origin.
namespace csrbf::winding {

/// The field in a cube is interpolated at order^3 points: tricubic, which gives the error in winding_number.hpp.
inline constexpr int order = 4;
inline constexpr int layer = order * order;
using Coefficients = std::array<float, order * layer>;

/// Samples [begin, end).
struct Range {
  std::int32_t begin, end;
};

/// A cube of space: the field of the samples outside `near` as a polynomial, degree 3 in each of t = (x - center) /
/// half; the coefficient of tx^i ty^j tz^k is far[16 i + 4 j + k].
struct Cell {
  Point<3> center = Point<3>::Zero();
  double half = 0;
  Coefficients far{};
  std::vector<Range> near;

  /// Whether Cubes::find() leads here from the cubes around.
  [[nodiscard]] bool contains(const Point<3>& x) const {
    return (x.array() > center.array() - half).all() && (x.array() <= center.array() + half).all();
  }
};

/// u + 1 at one point, its 3 first and 6 second derivatives.
using Sums = std::array<double, 10>;

/// Sums the polynomial and the near samples of a cell at the point x.
Sums sum_cell(const Tree& tree, const Cell& cell, const Point<3>& x, Derivatives derivatives);

/// Points at which sources far from a cube are evaluated, and the sums there.
struct Layer {
  alignas(64) double x[3][layer];
  alignas(64) float sum[layer];
};

/// Adds the expansions of some nodes and all samples of other nodes.
void add_sources(const Tree& tree, std::span<const std::int32_t> nodes, std::span<const std::int32_t> leaves,
                 Layer& at);

}  // namespace csrbf::winding
