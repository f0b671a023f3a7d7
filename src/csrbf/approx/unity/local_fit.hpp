#pragma once

#include "csrbf/approx/unity/cover.hpp"
#include "csrbf/approx/unity/local_models.hpp"
#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/linalg/batched_cholesky.hpp"

#include <cstdint>
#include <utility>
#include <vector>

namespace csrbf {

/// The samples of a patch: squared distances and columns of the points of a cover; and a metric, see
/// find_patch_samples().
template <int Dim>
struct FoundSamples {
  std::vector<std::pair<double, std::uint32_t>> found = {};  ///< empty: not known yet
  Eigen::Matrix<double, Dim, Dim> metric;
};

/// Fits local functions to samples around the middles of cells (see find_patch_samples), eight at a time:
///
/// * with a centre at every sample, a least squares polynomial, whose residual is interpolated by radial functions (for
///   smoothing = 0; thesis sections 1.3 and 3.1);
/// * with fewer centres, polynomial and radial functions together by least squares.
///
/// Work arrays are kept: one fitter per thread. O(samples^3 / 3) per patch, or O(samples (Q + centers)^2).
template <int Dim>
class LocalFitter {
 public:
  static constexpr int lanes = batch_lanes;

  /// values (N x components) and weights (N, positive, of mean 1, or empty) in the order of cover.points(); all must
  /// outlive the fitter.
  LocalFitter(const Cover<Dim>& cover, const Eigen::MatrixXd& values, const Eigen::VectorXd& weights,
              const LocalOptions& options);

  /// An empty collection of models of the kind that this fitter fits.
  [[nodiscard]] LocalModels<Dim> models() const;

  /// Fits `count` <= 8 models: model first + s of `models` for cell cells[s]. `known`: the samples of each, found by
  /// another fitter with as many and the same anisotropy, or empty; they are then stored there. None: they are not
  /// kept.
  void fit(const Index* cells, int count, LocalModels<Dim>& models, Index first,
           FoundSamples<Dim>* const* known = nullptr);

  /// Leave-one-out errors of the `targets` samples nearest to the middle of each of the patches last fitted:
  /// error[(lane * components + component) * targets + k]. With radial functions at all samples the polynomial is
  /// treated as part of the interpolant (Rippa 1999), otherwise the fit as a linear smoother.
  void left_out_errors(Index targets, double* error);

  [[nodiscard]] Index samples() const { return n_; }

 private:
  void gather(const Index* cells, int count, LocalModels<Dim>& models, Index first, FoundSamples<Dim>* const* known);
  void polynomial_rows(Index width);
  void fit_interpolant(LocalModels<Dim>& models, Index first, int count);
  void fit_least_squares(LocalModels<Dim>& models, Index first, int count);
  void interpolant_errors(Index targets, double* error);
  void least_squares_errors(Index targets, double* error);
  [[nodiscard]] bool interpolates() const { return M_ == n_; }

  const Cover<Dim>& cover_;
  const Eigen::MatrixXd& values_;
  const Eigen::VectorXd& weights_;
  LocalOptions options_;
  Kernel kernel_;
  Polynomials<Dim> basis_;
  Index n_, M_, Q_, C_;
  bool anisotropic_;
  double inverse_support2_;
  typename Cover<Dim>::Search search_;
  FoundSamples<Dim> patch_;
  std::vector<Index> center_rows_;  // samples that are centres
  // Eight lanes interleaved in everything that follows.
  std::vector<double> q_;              // n x Dim
  std::vector<double> s_;              // C x n, then the residual, then the coefficients alpha
  std::vector<double> weight_;         // n, square roots
  std::vector<double> F_;              // rows of the least squares system
  std::vector<double> G_;              // its normal equations
  std::vector<double> r2_, A_, work_;  // kernel matrix of the samples
};

}  // namespace csrbf
