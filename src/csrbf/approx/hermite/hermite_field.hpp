#pragma once

#include "csrbf/approx/hermite/hermite_kernel.hpp"
#include "csrbf/approx/unity/cover.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/core/once.hpp"
#include "csrbf/linalg/decompositions.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace csrbf {

/// Samples with values and derivatives, and the system of their covariances, in units of the length of the kernel.
template <int Dim>
struct HermiteSystem {
  static constexpr Index rows_each = 1 + Dim;

  Points<Dim> centers;  ///< n
  Eigen::MatrixXd
      nuggets;  ///< n x (1 + Dim): noise of the value and of each derivative over sigma^2; infinite: unknown

  [[nodiscard]] Index size() const { return centers.cols(); }
  /// The rows that are known: (1 + Dim) i for the value of sample i, then its derivatives.
  [[nodiscard]] std::vector<Index> known() const;
  /// Of the known rows, with noise.
  [[nodiscard]] Eigen::MatrixXd matrix(const HermiteKernel& kernel) const;
  /// Covariances of f(x) with all rows, known or not.
  [[nodiscard]] Eigen::VectorXd covariances(const HermiteKernel& kernel, const Point<Dim>& x) const;
};

/// A factor of the system and of its constant trend.
template <int Dim>
struct HermiteFactor {
  /// Adds noise until the matrix is positive definite: see `jitter`.
  HermiteFactor(const HermiteKernel& kernel, const HermiteSystem<Dim>& system);

  std::vector<Index> known;
  Eigen::LLT<Eigen::MatrixXd> llt;
  Eigen::VectorXd trend;   ///< L^-1 g, g = 1 for values and 0 for derivatives
  double information = 0;  ///< |trend|^2
  double jitter = 0;

  /// Variance of f(x) over sigma^2, without noise.
  [[nodiscard]] double variance(const HermiteKernel& kernel, const HermiteSystem<Dim>& system,
                                const Point<Dim>& x) const;
};

/// Sums of covariances of values and derivatives, on one system or blended from systems on the supports of a cover:
///
///     f(x) = m + sum_i a_i psi_0(x - x_i) - b_i . (x - x_i) psi_1(x - x_i)
///
/// (Hermite-Birkhoff interpolation; Wu 1992), or the variance of such a sum.
template <int Dim>
class HermiteField : public Field<Dim> {
 public:
  struct Patch {
    Points<Dim> centers;           ///< n
    Eigen::MatrixXd coefficients;  ///< (1 + Dim) n x k
    Eigen::VectorXd mean;          ///< k
    Eigen::VectorXd variance;      ///< k: of a sample, about the patch
  };
  struct Data {
    HermiteKernel kernel{"gaussian"};
    std::vector<Patch> patches;
    std::optional<Cover<Dim>> cover = {};           ///< none: one patch
    std::optional<HermiteSystem<Dim>> system = {};  ///< of the one patch
    Eigen::VectorXd sigma2 = {};                    ///< k, then
    double noise = 0;                               ///< of a sample of mean weight over sigma2, then
    Box<Dim> box = {};
  };

  HermiteField(std::shared_ptr<const Data> data, Index component, bool is_variance)
      : data_(std::move(data)), component_(component), is_variance_(is_variance) {}

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override;
  [[nodiscard]] Box<Dim> bounds() const override { return data_->box; }

  [[nodiscard]] const std::shared_ptr<const Data>& data() const { return data_; }
  [[nodiscard]] Index component() const { return component_; }
  [[nodiscard]] bool is_variance() const { return is_variance_; }

 private:
  struct PointJet;
  void add_patch(const Patch& patch, const Point<Dim>& x, PointJet& f) const;
  [[nodiscard]] PointJet at(const Point<Dim>& x) const;
  [[nodiscard]] double variance_at(const Point<Dim>& x) const;

  std::shared_ptr<const Data> data_;
  Index component_;
  bool is_variance_;
  mutable Once once_;
  mutable std::unique_ptr<const HermiteFactor<Dim>> factor_;
};

}  // namespace csrbf
