#pragma once

#include "csrbf/approx/unity/cover.hpp"
#include "csrbf/approx/unity/local_models.hpp"
#include "csrbf/core/field.hpp"

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace csrbf {

/// Supports, and a local function in each.
template <int Dim>
struct PartitionOfUnityData {
  Cover<Dim> cover;
  LocalModels<Dim> models;
  /// Local functions of another kind, for supports in gaps between samples; those supports have no use for `models`.
  LocalModels<Dim> wide = {};
  std::vector<std::int32_t> wide_of = {};  ///< per support: its function in `wide`, or -1; empty: there is none

  [[nodiscard]] bool is_wide(Index support) const { return !wide_of.empty() && wide_of[support] >= 0; }
};

/// Evaluates the local functions of supports. Keeps work arrays: one per thread.
template <int Dim>
class SupportEvaluator {
 public:
  explicit SupportEvaluator(const PartitionOfUnityData<Dim>& data)
      : data_(data), fine_(data.models), wide_(data.wide) {}

  /// See LocalEvaluator::evaluate().
  void evaluate(Index support, Index component, const double* x, Derivatives derivatives,
                double (*f)[LocalEvaluator<Dim>::lanes]) {
    if (data_.is_wide(support))
      wide_.evaluate(data_.wide_of[support], component, x, derivatives, f);
    else
      fine_.evaluate(support, component, x, derivatives, f);
  }

 private:
  const PartitionOfUnityData<Dim>& data_;
  LocalEvaluator<Dim> fine_, wide_;
};

/// f = sum_i w_i f_i / sum_i w_i with local functions f_i on the supports of a cover (thesis eq. (1.10); Babuska and
/// Melenk 1997). The weight of a support is the product over the axes of (1 - t^2)^4, t from -1 to 1 across it, so f
/// has three continuous derivatives where the local functions have.
///
/// Outside the box of the cover f has its value at the nearest point of the box: it is bounded and continuous, and its
/// gradient has no component out of the box.
template <int Dim>
class PartitionOfUnity : public Field<Dim> {
 public:
  using Data = PartitionOfUnityData<Dim>;

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

/// Side of a support over that of its cell: every point is in about three supports. Chosen by hand: larger supports
/// blend more smoothly, smaller ones evaluate faster.
template <int Dim>
inline constexpr double cover_growth = Dim == 1   ? 2.0
                                       : Dim == 2 ? 1.7
                                       : Dim == 3 ? 1.5
                                       : Dim == 4 ? 1.4
                                                  : 1.3;

}  // namespace csrbf
