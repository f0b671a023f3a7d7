#pragma once

#include "csrbf/approx/sums/box_tree.hpp"
#include "csrbf/approx/sums/radial_sums.hpp"
#include "csrbf/core/field.hpp"

#include <memory>

namespace csrbf {

/// Expansions of one set of coefficients: what FastSum::evaluate() needs besides the centres.
struct FarField {
  Eigen::VectorXd slots;                ///< the coefficients in the order of the tree
  std::vector<Eigen::MatrixXd> local;   ///< per level: rank x boxes
  std::vector<Eigen::MatrixXd> source;  ///< the same for the points inside of the boxes
};

/// Sums f(x) = sum_j alpha_j phi(|x - c_j| / sigma) over n centres, at n or more points, in O(n) instead of O(n^2)
/// operations for any kernel that is smooth away from its centre and at the edge of its support, in one to three
/// dimensions: the fast multipole method (Greengard and Rokhlin 1987) with expansions by interpolation, see
/// BoxOperators.
///
/// Values differ from the direct sum by at most a few `tolerance` times the largest |phi| between the points, or
/// |phi(0)|, times the norm of the coefficients; gradients and Hessians by that over the distance at which expansions
/// end (a few spacings) and its square. Results do not depend on the number of threads. Immutable and thread safe.
///
/// Memory: about 16 rank / leaf_size + 60 bytes per centre, and more for small tolerances.
template <int Dim>
class FastSum {
 public:
  /// Throws InvalidInput for centres that are not finite and for supports and tolerances that are not positive.
  FastSum(const PointsRef<Dim>& centers, const Kernel& kernel, double support, const TreeOptions& options = {});

  [[nodiscard]] Index size() const { return std::ssize(tree_.order); }

  /// The sums at the centres, for `options.everywhere` true or false.
  [[nodiscard]] Eigen::VectorXd multiply(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const;

  /// To be evaluated anywhere, with `options.everywhere`; on all threads.
  [[nodiscard]] FarField expand(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const;

  /// Adds the sums and the derivatives requested by `out` at a block of points on the calling thread. Far outside of
  /// the box of the centres, each takes O(log n) operations.
  void add_sums(const FarField& field, const PointsRef<Dim>& x, const JetBlock& out) const;

  [[nodiscard]] const BoxTree<Dim>& tree() const { return tree_; }

 private:
  struct Run {
    Index begin, end;  // slots
  };

  void number_slots(const PointsRef<Dim>& centers);
  void list_shifts();
  [[nodiscard]] Eigen::VectorXd to_slots(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const;
  void gather_sources(FarField& field) const;
  void translate(FarField& field) const;
  [[nodiscard]] Points<Dim> points_of(const TreeBox<Dim>& box) const;
  [[nodiscard]] Index first_slot(const TreeBox<Dim>& box) const;
  [[nodiscard]] std::vector<Run> runs(const std::vector<std::int32_t>& near) const;
  void add_near(const std::vector<Run>& runs, const double* slots, const Points<Dim>& x, const JetBlock& out) const;
  void add_direct(const CenterArrays& centers, const std::vector<Run>& runs, const double* slots, const Points<Dim>& x,
                  const JetBlock& out) const;
  void add_local(const FarField& field, Index box, const Points<Dim>& x, const JetBlock& out) const;
  void add_outside(const FarField& field, const Points<Dim>& x, const JetBlock& out) const;
  void sum_leaf(const FarField& field, Index leaf, const Points<Dim>& x, const JetBlock& out) const;

  Kernel kernel_;
  double support_;
  BoxTree<Dim> tree_;
  std::vector<Index> slot_;                              // first slot of each box with few points, below one with more
  std::vector<Run> span_;                                // slots of all points of these boxes and those above them
  Eigen::MatrixXd position_;                             // slots x Dim
  Eigen::VectorXd shape_;                                // 1 / support^2
  std::vector<std::vector<Eigen::MatrixXd>> to_parent_;  // per level and corner of the children
};

}  // namespace csrbf
