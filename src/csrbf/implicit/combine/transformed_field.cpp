#include "csrbf/implicit/combine/transformed_field.hpp"

namespace csrbf {

void TransformedField::evaluate_block(const PointsRef<3>& x, const JetBlock& out) const {
  data_.inner->evaluate_block(to_inner(x), out);
  Eigen::Map<Eigen::VectorXd>(out.value, x.cols()) *= data_.scale;
  if (out.hessian != nullptr) Eigen::Map<Eigen::VectorXd>(out.hessian, symmetric_size<3> * x.cols()) /= data_.scale;
}

Points<3> TransformedField::seeds() const {
  if (data_.seeds.cols() > 0) return data_.seeds;
  return (data_.scale * data_.inner->seeds()).colwise() + data_.origin;
}

std::vector<Index> TransformedField::evaluation_order(const PointsRef<3>& x) const {
  return data_.inner->evaluation_order(to_inner(x));
}

}  // namespace csrbf
