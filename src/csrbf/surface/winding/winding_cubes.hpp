#pragma once

#include "csrbf/surface/winding/winding_kernels.hpp"

#include <atomic>
#include <memory>

namespace csrbf::winding {

/// Cubes that were made, parents first, as a file keeps them.
struct MadeCubes {
  std::vector<std::uint8_t> children;  ///< which of the eight follow, bit by bit
  std::vector<std::int32_t> near;      ///< how many numbers follow, and these: nodes, or where ranges begin and end
  std::vector<float> far;              ///< coefficients
};

/// An octree of cells around a tree of samples, subdivided until few samples are near a cell. Cells are created when a
/// point in them is first requested; their content does not depend on when. Lengths in units of the tree.
class Cubes {
 public:
  /// Half side of the root: eight times the half extent of the samples at least; beyond, one expansion suffices.
  static constexpr double extent = 4;

  explicit Cubes(const Tree& tree);
  /// With those that made() has told of the same tree. Throws InvalidInput if they cannot be of it.
  Cubes(const Tree& tree, const MadeCubes& made);

  /// Those made so far. Not while others are evaluated.
  [[nodiscard]] MadeCubes made() const;

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

  class Reader;

  static std::unique_ptr<Cube> place_child(const Cube& parent, std::size_t octant);
  static void tell(const Cube& cube, MadeCubes& made);
  std::unique_ptr<Cube> make_child(const Cube& parent, std::size_t octant) const;
  Sources classify(const Cell& cell, const std::vector<std::int32_t>& candidates) const;
  void set_near(Cube& cube, std::vector<std::int32_t> near) const;

  const Tree& tree_;
  Cube root_;
};

}  // namespace csrbf::winding
