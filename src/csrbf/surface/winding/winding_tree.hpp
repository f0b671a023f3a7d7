#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

/// The parts of WindingNumber. Internal.
namespace csrbf::winding {

/// Samples of a surface, one column or entry each: position p, unit outward normal n, area a, smoothing length eps.
struct Samples {
  Points<3> points{3, 0};
  Points<3> normals{3, 0};
  Eigen::VectorXd areas;
  Eigen::VectorXd eps;
};

/// The same by reference.
struct SamplesRef {
  PointsRef<3> points, normals;
  Eigen::Ref<const Eigen::VectorXd> areas, eps;
};

/// Samples [begin, begin + count) and the expansion of their field about `center`, lengths in units of 1 /
/// inverse_scale, which is the radius of the node. With r = center - x, D = r^2 + eps2 and d = p - center,
///   u + 1 = N(r) D^(-3/2) + ((tr A)(r) + A(r)) D^(-5/2) + Q(r) D^(-7/2) + O(radius / |r|)^3.
struct Node {
  double center[3];
  double inverse_scale;
  float eps2;          ///< mean squared smoothing length
  float dipole[3];     ///< form sum a n.r / 2 pi
  float quadratic[6];  ///< form -3 sum a (n.r)(d.r) / 2 pi: xx xy xz yy yz zz
  float cubic[10];     ///< form 7.5 sum a (n.r)(d.r)^2 / 2 pi: xxx xxy xxz xyy xyz xzz yyy yyz yzz zzz
  std::int32_t right;  ///< index of the right child, the left one follows its parent; 0 for a leaf
  std::int32_t begin;
  std::int32_t count;

  [[nodiscard]] bool is_leaf() const { return right == 0; }
  [[nodiscard]] double radius() const { return 1 / inverse_scale; }
};

/// Number of samples summed at a time; the arrays of a tree are padded by it.
inline constexpr int lanes = 8;

/// The samples as the inner loops read them, sorted so that every node is a range, and the nodes in depth-first order:
/// parent, left subtree, right subtree.
struct Tree {
  /// Coordinates are integers: origin + unit / resolution * x. 28 bits leave room for differences in 32.
  static constexpr double resolution = 1 << 28;

  Point<3> origin = Point<3>::Zero();
  double unit = 1;  ///< a power of two, not less than the extent of the samples
  std::vector<Node> nodes;
  Points<3> points{3, 0};
  std::vector<std::int32_t> x[3];
  std::vector<float> strength[3];  ///< a n / (2 pi unit^2)
  std::vector<float> eps2;         ///< (eps / unit)^2
};

/// Sorts samples into a tree. O(n log n). Samples returned by `samples_of` give a bit-identical tree.
Tree make_tree(const SamplesRef& samples);

/// The samples of a tree in its order; normals, areas and smoothing lengths rounded to single precision.
Samples samples_of(const Tree& tree);

}  // namespace csrbf::winding
