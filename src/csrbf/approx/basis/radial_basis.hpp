#pragma once

#include "csrbf/approx/basis/support_tree.hpp"
#include "csrbf/approx/sums/radial_sums.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/kernels/kernel.hpp"

#include <Eigen/SparseCore>

#include <memory>
#include <vector>

namespace csrbf {

template <int Dim>
class FastSum;

/// How a radial basis measures distances.
template <int Dim>
struct RadialMetric {
  /// Matrices T: the distance of p to centre j is |T (p - c_j)|. None: Euclidean; one: common to all centres; or one
  /// per centre (the basis functions have ellipsoids as supports).
  std::vector<Eigen::Matrix<double, Dim, Dim>> transforms = {};
  /// Length of each periodic axis (longitude: 360), 0 for axes that are not periodic. Every basis function is repeated
  /// with the period, which keeps compactly supported kernels positive definite. Needs a compact kernel.
  Point<Dim> periods = Point<Dim>::Zero();
};

/// Functions phi_j(p) = phi(|p - c_j| / sigma_j), j < M, of one kernel: centres with a common support radius or one
/// each, and optionally a metric. Basis functions of a compact kernel are found through trees, so that evaluation costs
/// O(log M + number of supports that contain the point); others are summed over all centres, or where these are many by
/// fast_sum(). Immutable and thread safe.
template <int Dim>
class RadialBasis {
 public:
  /// `supports` (radius of the support; for a kernel without one its length scale) has one entry or one per centre.
  /// Throws InvalidInput for centres that are not finite, supports that are not positive and finite or of the wrong
  /// number, singular transforms, negative periods, periods with a kernel that is not compact, and more than 1000
  /// repetitions.
  RadialBasis(const Kernel& kernel, const PointsRef<Dim>& centers, const Eigen::VectorXd& supports,
              const RadialMetric<Dim>& metric = {});

  [[nodiscard]] Index size() const { return centers_.cols(); }
  [[nodiscard]] const Kernel& kernel() const { return kernel_; }
  [[nodiscard]] const Points<Dim>& centers() const { return centers_; }
  [[nodiscard]] const Eigen::VectorXd& supports() const { return supports_; }  ///< as given: 1 or M
  [[nodiscard]] double support(Index j) const { return supports_[supports_.size() == 1 ? 0 : j]; }
  [[nodiscard]] const RadialMetric<Dim>& metric() const { return metric_; }

  /// B_kj = phi_j(p_k), N x M, without its zeros; rows are sorted. For compact kernels. On all threads.
  [[nodiscard]] Eigen::SparseMatrix<double, Eigen::RowMajor> matrix(const PointsRef<Dim>& points) const;

  /// B_kj = phi_j(p_k), N x M, for any kernel.
  [[nodiscard]] Eigen::MatrixXd dense_matrix(const PointsRef<Dim>& points) const;

  /// The basis functions whose supports may meet the box: all of those that do, for a Euclidean basis that is not
  /// periodic. O(log M + their number).
  [[nodiscard]] std::vector<Index> reaching(const Box<Dim>& box) const;

  /// Coefficients (M) in the order required by add_sums.
  [[nodiscard]] Eigen::VectorXd to_slots(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const;

  /// For more than 8000 centres of a kernel that is not compact, in one to three dimensions, with one support and at
  /// most one transform; else null. In coordinates to which the transform is applied. Made at the first call.
  [[nodiscard]] const FastSum<Dim>* fast_sum() const;

  /// Adds sum_j alpha_j phi_j and the derivatives requested by `out` at a block of points.
  void add_sums(const PointsRef<Dim>& x, const Eigen::VectorXd& slot_coefficients, const JetBlock& out) const;

 private:
  using Matrix = Eigen::Matrix<double, Dim, Dim>;
  using Runs = std::vector<typename SupportTree<Dim>::Run>;

  void check() const;
  void list_shifts();
  void fill_arrays(const Points<Dim>& mapped);
  [[nodiscard]] Eigen::VectorXd search_radii() const;
  [[nodiscard]] Point<Dim> wrapped(const Point<Dim>& x) const;
  [[nodiscard]] CenterArrays arrays() const;
  [[nodiscard]] bool common_transform() const { return metric_.transforms.size() == 1; }
  [[nodiscard]] bool own_transforms() const { return metric_.transforms.size() > 1; }
  template <class Use>
  void for_each_batch(const Point<Dim>& x, bool with_directions, Runs& runs, RadialBatch& batch, const Use& use) const;
  template <class Visit>
  void for_each_entry(const Point<Dim>& x, Runs& runs, RadialBatch& batch, const Visit& visit) const;
  void row(const Point<Dim>& x, Runs& runs, RadialBatch& batch, std::vector<std::pair<int, double>>& entries) const;

  struct LazyFastSum;

  Kernel kernel_;
  Points<Dim> centers_;
  Eigen::VectorXd supports_;
  RadialMetric<Dim> metric_;
  std::shared_ptr<LazyFastSum> fast_sum_;  // null where it is of no use
  Matrix transform_ = Matrix::Identity();  // the common one
  std::vector<Point<Dim>> shifts_;         // of the query, before the transform
  SupportTree<Dim> tree_;
  Eigen::MatrixXd position_;  // slots x Dim
  Eigen::MatrixXd shape_;     // slots x 1, or x symmetric_size
};

}  // namespace csrbf
