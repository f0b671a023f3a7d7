#pragma once

#include "csrbf/surface/winding/winding_kernels.hpp"

#include <atomic>
#include <memory>

namespace csrbf::winding {

/// An octree of cells around a tree of samples, subdivided until few samples are near a cell. Cells are created when a
/// point in them is first requested; their content does not depend on when. Lengths in units of the tree.
class Cubes {
 public:
  /// Half side of the root: eight times the half extent of the samples at least; beyond, one expansion suffices.
  static constexpr double extent = 4;

  explicit Cubes(const Tree& tree);

  /// The leaf cell that contains x, null outside the root. Thread safe.
  const Cell* find(const Point<3>& x) const;

 private:
  struct Cube {
    Cell cell;
    int depth = 0;
    bool divided = false;
    std::vector<std::int32_t> near;  // nodes, while divided
    mutable std::array<std::atomic<const Cube*>, 8> children{};

    Cube() = default;
    Cube(const Cube&) = delete;
    Cube& operator=(const Cube&) = delete;
    ~Cube();
  };
  // Nodes of the tree by the way they act on a cube.
  struct Sources {
    std::vector<std::int32_t> near, expansions, leaves;
  };

  std::unique_ptr<Cube> make_child(const Cube& parent, std::size_t octant) const;
  Sources classify(const Cell& cell, const std::vector<std::int32_t>& candidates) const;
  void set_near(Cube& cube, std::vector<std::int32_t> near) const;

  const Tree& tree_;
  Cube root_;
};

}  // namespace csrbf::winding
