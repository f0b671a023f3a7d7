#pragma once

#include "csrbf/approx/faults/fault_lines.hpp"
#include "csrbf/approx/kriging/covariance.hpp"
#include "csrbf/approx/unity/local_models.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace csrbf {

/// Local functions on discs in the plane, whose points see their anchors past faults, blended:
///
///     f(x) = sum_k w_k f_k / sum_k w_k,   w_k = max(0, 1 - (d_k^2 / (|x - x_k| R_k))^2)^4
///
/// with the length d_k of the shortest way from the anchor x_k that crosses no fault (see FaultLines): discontinuous
/// across faults, continuous around their ends. Where no disc reaches, the function of the nearest anchor that is seen
/// counts.
class FaultField : public Field<2> {
 public:
  /// What the local functions are predictions by. The samples of a patch are the centres of its function.
  struct Prediction {
    double nugget = 0;
    Eigen::VectorXd sigma2;   ///< of all samples, by component
    Eigen::MatrixXd weights;  ///< of its samples, by patch; 0 beyond them
  };

  struct Data {
    /// `variances`: by component and patch: sigma^2 of its samples or, without `prediction` (in older models), of the
    /// difference between a sample and the function all over the patch.
    Data(FaultLines faults, Points<2> anchors, Eigen::VectorXd radii, LocalModels<2> models, Eigen::MatrixXd variances,
         const Box<2>& box, std::optional<Prediction> prediction = {});

    FaultLines faults;
    Points<2> anchors;
    Eigen::VectorXd radii;
    LocalModels<2> models;
    Eigen::MatrixXd variances;
    Box<2> box;
    std::optional<Prediction> prediction;
    std::vector<FaultLines::Nearby> nearby;  ///< of each patch
    /// Patches by size: those of a class have at most this radius.
    struct SizeClass {
      double radius;
      std::vector<Index> patches;
      Points<2> anchors;
      std::unique_ptr<const KdTree<2>> tree;
    };
    std::vector<std::unique_ptr<const SizeClass>> classes;
  };

  FaultField(std::shared_ptr<const Data> data, Index component, bool is_variance)
      : data_(std::move(data)), component_(component), is_variance_(is_variance) {}

  void evaluate_block(const PointsRef<2>& x, const JetBlock& out) const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<2>& x) const override;
  [[nodiscard]] Box<2> bounds() const override { return data_->box; }

  [[nodiscard]] const std::shared_ptr<const Data>& data() const { return data_; }
  [[nodiscard]] Index component() const { return component_; }
  [[nodiscard]] bool is_variance() const { return is_variance_; }

 private:
  std::shared_ptr<const Data> data_;
  Index component_;
  bool is_variance_;
};

}  // namespace csrbf
