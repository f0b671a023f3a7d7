#pragma once

#include "csrbf/core/field.hpp"

namespace csrbf::baselines {

/// A field given by values only; derivatives are central differences.
class ValueField : public Field<3> {
 public:
  /// `step`: half the width of the differences.
  ValueField(const Box<3>& bounds, double step) : bounds_(bounds), step_(step) {}

  [[nodiscard]] virtual double value(const Point<3>& x) const = 0;

  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<3> bounds() const override { return bounds_; }

 private:
  Box<3> bounds_;
  double step_;
};

}  // namespace csrbf::baselines
