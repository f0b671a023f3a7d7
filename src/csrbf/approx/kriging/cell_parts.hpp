#pragma once

#include "csrbf/approx/unity/cover.hpp"
#include "csrbf/approx/unity/local_models.hpp"

#include <memory>
#include <utility>
#include <vector>

namespace csrbf {

/// A part of a cell of a partition of unity, in preorder.
template <int Dim>
struct CellPart {
  std::int8_t axis = -1;
  double split = 0;
  std::size_t right = 0;  ///< of the parts of this cell
  Eigen::VectorXd variance = {};
  bool is_wide = false;                                    ///< with another function, in a gap
  std::unique_ptr<const LocalModels<Dim>> wide = nullptr;  ///< which; null: not known yet
};

/// The parts of every cell; of those that are not split one.
template <int Dim>
using CellParts = std::vector<std::vector<CellPart<Dim>>>;

/// A cell of another cover, and the part that it is.
template <int Dim>
using PlacedPart = std::pair<Index, const CellPart<Dim>*>;

/// Halves part `at`, a box, across its longest axis. `append(half)` appends the parts of a half.
template <int Dim, class Append>
void halve(std::vector<CellPart<Dim>>& parts, std::size_t at, const Box<Dim>& box, const Append& append) {
  Index axis = 0;
  box.extent().maxCoeff(&axis);
  parts[at].axis = static_cast<std::int8_t>(axis);
  parts[at].split = box.center()[axis];
  Box<Dim> lower = box, upper = box;
  lower.hi[axis] = upper.lo[axis] = parts[at].split;
  append(lower);
  parts[at].right = parts.size();
  append(upper);
}

/// The tree with parts in the place of its cells; `leaves`: the cells of the new one.
template <int Dim>
typename Cover<Dim>::Tree tree_of_parts(const typename Cover<Dim>::Tree& old, const CellParts<Dim>& parts,
                                        std::vector<PlacedPart<Dim>>& leaves);

}  // namespace csrbf
