#pragma once

#include "csrbf/approx/transform/value_transform.hpp"
#include "csrbf/core/field.hpp"

#include <limits>
#include <memory>

namespace csrbf {

/// What a function z on another scale says of the values v themselves: of `value`, their mean at a place, over the
/// noise of z; of `sample` and `function`, the mean squared difference to that of a sample, or of the mean if z were
/// known. z at a place is normal, with a mean and a variance that counts the noise. Derivatives of the latter two are
/// NaN.
template <int Dim>
class TransformedBack : public Field<Dim> {
 public:
  using Part = std::shared_ptr<const Field<Dim>>;
  enum class Of { value, sample, function };
  struct Parts {
    Transform transform = Transform::none;
    Of of = Of::value;
    double noise = 0;    ///< standard deviation of a sample of z
    Part mean;           ///< of z
    Part variance = {};  ///< of a sample of z; null for `value`
    /// What counts of a variance at most: far from all samples, where it grows as a trend of z may, it says nothing of
    /// exp(z).
    double largest = std::numeric_limits<double>::infinity();
  };

  explicit TransformedBack(Parts parts) : parts_(std::move(parts)) {}

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] Eigen::VectorXd evaluate_grid(const GridAxes<Dim>& axes) const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override {
    return parts_.mean->evaluation_order(x);
  }
  [[nodiscard]] Box<Dim> bounds() const override { return parts_.mean->bounds(); }
  [[nodiscard]] double feature_size() const override { return parts_.mean->feature_size(); }

  [[nodiscard]] const Parts& parts() const { return parts_; }

 private:
  Parts parts_;
};

}  // namespace csrbf
