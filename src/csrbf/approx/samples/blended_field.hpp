#pragma once

#include "csrbf/core/field.hpp"

#include <memory>

namespace csrbf {

/// f = other + share (one - other), with a share that is a field too: one field where the share is 1, another where it
/// is 0, and smooth between. Each is evaluated only where it counts. Without another field it is 0: f = share one.
template <int Dim>
class BlendedField : public Field<Dim> {
 public:
  using Part = std::shared_ptr<const Field<Dim>>;
  BlendedField(Part one, Part other, Part share)
      : one_(std::move(one)), other_(std::move(other)), share_(std::move(share)) {}

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override {
    return share_->evaluation_order(x);
  }
  [[nodiscard]] Box<Dim> bounds() const override { return one_->bounds(); }

  [[nodiscard]] const Field<Dim>& one() const { return *one_; }
  [[nodiscard]] const Field<Dim>* other() const { return other_.get(); }  ///< null: none
  [[nodiscard]] const Field<Dim>& share() const { return *share_; }

 private:
  Part one_, other_, share_;
};

}  // namespace csrbf
