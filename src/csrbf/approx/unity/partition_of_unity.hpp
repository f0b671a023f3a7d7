#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/approx/unity/cover.hpp"
#include "csrbf/approx/unity/local_fit.hpp"
#include "csrbf/approx/unity/local_models.hpp"
#include "csrbf/core/progress.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace csrbf {

/// f = sum_i w_i f_i / sum_i w_i with local functions f_i on the supports of a cover (thesis eq. (1.10); Babuska and
/// Melenk 1997). The weight of a support is the product over the axes of (1 - t^2)^4, t from -1 to 1 across it, so f
/// has three continuous derivatives where the local functions have.
///
/// Outside the box of the cover f has its value at the nearest point of the box: it is bounded and continuous, and its
/// gradient has no component out of the box.
template <int Dim>
class PartitionOfUnity : public Field<Dim> {
 public:
  struct Data {
    Cover<Dim> cover;
    LocalModels<Dim> models;
  };

  /// The field of one component of the values.
  PartitionOfUnity(std::shared_ptr<const Data> data, Index component = 0)
      : data_(std::move(data)), component_(component) {}

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override;
  [[nodiscard]] Eigen::VectorXd evaluate_grid(const GridAxes<Dim>& axes) const override;
  [[nodiscard]] Box<Dim> bounds() const override { return data_->cover.box(); }
  [[nodiscard]] double feature_size() const override;

  [[nodiscard]] const Data& data() const { return *data_; }
  [[nodiscard]] Index component() const { return component_; }

 private:
  std::shared_ptr<const Data> data_;
  Index component_;
};

struct PartitionOfUnityOptions {
  /// Of the local functions; what is not given is chosen by cross-validation.
  std::optional<std::string> kernel = {};
  std::optional<int> degree = {};
  std::optional<Index> samples_per_patch = {};
  std::optional<Index> centers_per_patch = {};
  std::optional<double> anisotropy = {};
  std::optional<double> smoothing = {};
  /// Mean error, in the unit of the values, below which more accuracy is not worth any time; 0: 1e-10 of their range.
  double accuracy = 0;
  Progress progress = {};
};

struct PartitionOfUnityReport {
  LocalOptions local;
  Index patches = 0;
  Index centers = 0;                 ///< of all patches
  double cross_validation_rmse = 0;  ///< of samples predicted by patches fitted without them
};

/// One field per component of the values, all on the same cover.
template <int Dim>
struct PartitionOfUnityFit {
  std::shared_ptr<const typename PartitionOfUnity<Dim>::Data> data;
  PartitionOfUnityReport report;

  [[nodiscard]] std::vector<std::shared_ptr<const Field<Dim>>> fields() const;
};

/// Approximates samples by a partition of unity. For exact values it nearly interpolates, as each local function
/// interpolates the samples it is fitted to. O(n log n) time, O(n) memory. Samples at the same point must have been
/// merged; those of weight 0 are left out. Results do not depend on the units of points, values and weights.
/// Throws InvalidInput for invalid samples (see require_valid) and options: kernels must be positive definite, degrees
/// -1 to 8.
template <int Dim>
PartitionOfUnityFit<Dim> partition_of_unity(const Samples<Dim>& samples, const PartitionOfUnityOptions& options = {});

/// Side of a support over that of its cell: every point is in about three supports. Chosen by hand: larger supports
/// blend more smoothly, smaller ones evaluate faster.
template <int Dim>
inline constexpr double cover_growth = Dim == 1   ? 2.0
                                       : Dim == 2 ? 1.7
                                       : Dim == 3 ? 1.5
                                       : Dim == 4 ? 1.4
                                                  : 1.3;

}  // namespace csrbf
