#include "csrbf/implicit/plane_section.hpp"

namespace csrbf {

template <int Dim>
void PlaneSection<Dim>::evaluate_block(const PointsRef<2>& x, const JetBlock& out) const {
  const Points<Dim> in_space = (across_ * x).colwise() + origin_;
  Jet<Dim> jet(x.cols(), out.derivatives());
  field_.evaluate_block(in_space, {out.value, out.gradient != nullptr ? jet.gradient.data() : nullptr,
                                   out.hessian != nullptr ? jet.hessian.data() : nullptr});
  if (out.gradient != nullptr) Eigen::Map<Points<2>>(out.gradient, 2, x.cols()) = across_.transpose() * jet.gradient;
  if (out.hessian == nullptr) return;
  for (Index i = 0; i < x.cols(); ++i) {
    const Eigen::Matrix2d H = across_.transpose() * jet.hessian_matrix(i) * across_;
    Eigen::Map<Point<3>>(out.hessian + 3 * i) << H(0, 0), H(0, 1), H(1, 1);
  }
}

template <int Dim>
double PlaneSection<Dim>::feature_size() const {
  return field_.feature_size() / across_.colwise().norm().maxCoeff();
}

template <int Dim>
Eigen::VectorXd PlaneSection<Dim>::evaluate_grid(const GridAxes<2>& axes) const {
  std::array<Index, 2> row{};
  for (Index k = 0; k < 2; ++k) {
    across_.col(k).cwiseAbs().maxCoeff(&row[k]);
    if ((across_.col(k).array() != 0).count() != 1) return Field<2>::evaluate_grid(axes);
  }
  if (row[0] >= row[1]) return Field<2>::evaluate_grid(axes);
  GridAxes<Dim> in_space;
  for (Index a = 0; a < Dim; ++a) in_space[a].setConstant(1, origin_[a]);
  for (Index k = 0; k < 2; ++k) in_space[row[k]] = (axes[k].array() * across_(row[k], k) + origin_[row[k]]).matrix();
  return field_.evaluate_grid(in_space);
}

template class PlaneSection<2>;
template class PlaneSection<3>;

}  // namespace csrbf
