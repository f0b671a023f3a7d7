#pragma once

#include "csrbf/core/field.hpp"

#include <memory>

namespace csrbf {

/// A field in other coordinates: f(x) = inner(A x), with a matrix A that has an inverse. Axes that are turned and
/// scaled have orthogonal rows.
template <int Dim>
class MappedField : public Field<Dim> {
 public:
  using Map = Eigen::Matrix<double, Dim, Dim>;

  MappedField(std::shared_ptr<const Field<Dim>> inner, const Map& map) : inner_(std::move(inner)), map_(map) {}

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override;
  /// The box around what the inner box is in these coordinates.
  [[nodiscard]] Box<Dim> bounds() const override;
  [[nodiscard]] double feature_size() const override {
    return inner_->feature_size() / map_.rowwise().norm().maxCoeff();
  }

  [[nodiscard]] const Field<Dim>& inner() const { return *inner_; }
  [[nodiscard]] const Map& map() const { return map_; }

 private:
  std::shared_ptr<const Field<Dim>> inner_;
  Map map_;
};

}  // namespace csrbf
