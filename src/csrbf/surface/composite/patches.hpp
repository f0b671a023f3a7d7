#pragma once

#include "csrbf/core/field.hpp"

namespace csrbf {

/// How a piece of a patch joins the pieces before it.
enum class Join : std::int8_t {
  first,         ///< it is the first piece of its patch
  intersection,  ///< convex edges: the solid is where both are positive
  unite,         ///< concave edges, and sheets that face each other: where one of them is positive
};

/// One local model of a surface (thesis 6.1, eq. (6.2)): in the local coordinates q = T (x - center),
///   f(x) = radius * ( b . (1, qx, qy, qz, qx^2, qx qy, qx qz, qy^2, qy qz, qz^2) + sum_j alpha_j phi(|q - c_j| /
///   support) ),
/// a quadric plus a CSRBF residual (Wendland C4). T has orthogonal rows of length 1 / radius; its last row is along the
/// outward normal. The model holds where the weight w = (1 - d^2)^4 with d^2 = qx^2 + qy^2 + (flatness qz)^2 is
/// positive: inside an ellipsoid of tangential radius `radius` and normal radius `radius / flatness`.
/// Where the surface has creases or several sheets, a patch consists of consecutive pieces in the same frame: f is the
/// minimum or maximum of what they say, joined one after the other.
struct Patch {
  Point<3> center;
  Eigen::Matrix3d T;
  double radius = 0;
  double flatness = 1;
  Eigen::Matrix<double, 10, 1> quadric;
  Join join = Join::first;
};

/// Sums over patches at a point: W = sum w, S = sum w f, A = sum w f / radius and Q = sum w (f / radius)^2 with
/// derivatives. F = S / W is the blended model; V = Q / W - (A / W)^2, the variance of the local models in units of
/// their radii, measures their disagreement. Arrays hold `lanes` points each.
struct PatchSums {
  static constexpr int lanes = 64;
  static constexpr int max_terms = 10;  ///< value, 3 first, 6 second derivatives

  Derivatives derivatives = Derivatives::none;  ///< what was summed; other terms are undefined
  bool sharp = false;                           ///< whether w is cubed: the nearest patches decide
  alignas(64) double W[max_terms][lanes];
  alignas(64) double S[max_terms][lanes];
  alignas(64) double A[max_terms][lanes];
  alignas(64) double Q[max_terms][lanes];
};

/// Overlapping patches with a bounding volume hierarchy over their supports. Plain data: what a model file stores.
class Patches {
 public:
  /// Support radius of the radial basis functions, in units of the patch radius. Chosen by hand: above 2, each function
  /// covers the whole patch; larger values are smoother but worse conditioned.
  static constexpr double support = 2.5;

  Patches() = default;
  /// From what patches(), center_begin(), center_coordinates() and alpha() return; built.
  Patches(std::vector<Patch> patches, std::vector<Index> center_begin, std::vector<double> centers,
          std::vector<double> alpha);

  /// Reserves memory for patches with a number of centres each.
  void reserve(Index patches, Index centers_per_patch);

  /// Adds a patch, or a piece of the last one, with the CSRBF centres `centers` (3 x m, local coordinates) and
  /// coefficients `alpha` (m).
  void add(const Patch& patch, const PointsRef<3>& centers, const Eigen::Ref<const Eigen::VectorXd>& alpha);

  /// Builds the hierarchy; call after the last add. Patches added in spatial order make it tight.
  void build();

  /// Number of patches.
  [[nodiscard]] Index size() const { return size_; }
  /// Number of pieces of all patches.
  [[nodiscard]] Index pieces() const { return static_cast<Index>(patches_.size()); }
  /// Total number of CSRBF centres.
  [[nodiscard]] Index centers() const { return static_cast<Index>(alpha_.size()); }
  [[nodiscard]] const Patch& patch(Index piece) const { return patches_[piece]; }
  /// All pieces; those of a patch follow each other.
  [[nodiscard]] const std::vector<Patch>& patches() const { return patches_; }
  [[nodiscard]] const std::vector<Index>& center_begin() const { return center_begin_; }
  [[nodiscard]] const std::vector<double>& center_coordinates() const { return centers_; }
  [[nodiscard]] const std::vector<double>& alpha() const { return alpha_; }
  [[nodiscard]] Box<3> bounds() const { return nodes_.empty() ? Box<3>{} : nodes_.front().box; }

  /// Sums over all patches at up to PatchSums::lanes points (3 x count, close together).
  void accumulate(const PointsRef<3>& x, Derivatives derivatives, PatchSums& sums) const;

  /// The sums of weights W alone, which cost far less; some may be missing where all of W are `enough`.
  void weights(const PointsRef<3>& x, double* W, double enough = std::numeric_limits<double>::infinity()) const;

 private:
  struct Node {
    Box<3> box;
    Index begin, end;  // patches below, as positions in first_piece_
    Index right;       // index of the right child; the left one follows the node; 0 for a leaf
  };
  template <class Visit>
  void visit(const Box<3>& box, const Visit& visit) const;
  Index build_node(const std::vector<Box<3>>& boxes, Index begin, Index end);

  Index size_ = 0;
  std::vector<Patch> patches_;            // every piece
  std::vector<std::size_t> first_piece_;  // of each patch; at the end, the number of pieces
  std::vector<Index> center_begin_ = {0};
  std::vector<double> centers_;  // 3 per centre
  std::vector<double> alpha_;
  std::vector<Node> nodes_;
};

}  // namespace csrbf
