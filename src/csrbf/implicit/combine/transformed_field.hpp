#pragma once

#include "csrbf/core/field.hpp"

#include <memory>
#include <utility>

namespace csrbf {

/// A field moved and scaled: f(x) = scale * inner((x - origin) / scale). Gradients keep their length, so that a field
/// close to the signed distance remains so in the new unit.
class TransformedField final : public Field<3> {
 public:
  struct Data {
    std::shared_ptr<const Field<3>> inner;
    Point<3> origin = Point<3>::Zero();
    double scale = 1;
    double feature_size = 0;  ///< as Field::feature_size()
    Box<3> bounds;            ///< as Field::bounds()
    Points<3> seeds{3, 0};    ///< as Field::seeds(); none: those of the inner field
  };

  explicit TransformedField(Data data) : data_(std::move(data)) {}

  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override {
    data_.inner->evaluate_block(to_inner(x), out);
    Eigen::Map<Eigen::VectorXd>(out.value, x.cols()) *= data_.scale;
    if (out.hessian != nullptr) Eigen::Map<Eigen::VectorXd>(out.hessian, symmetric_size<3> * x.cols()) /= data_.scale;
  }
  [[nodiscard]] Box<3> bounds() const override { return data_.bounds; }
  [[nodiscard]] double feature_size() const override { return data_.feature_size; }
  [[nodiscard]] Points<3> seeds() const override {
    if (data_.seeds.cols() > 0) return data_.seeds;
    return (data_.scale * data_.inner->seeds()).colwise() + data_.origin;
  }
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<3>& x) const override {
    return data_.inner->evaluation_order(to_inner(x));
  }
  [[nodiscard]] const Data& data() const { return data_; }

 private:
  [[nodiscard]] Points<3> to_inner(const PointsRef<3>& x) const { return (x.colwise() - data_.origin) / data_.scale; }

  Data data_;
};

}  // namespace csrbf
