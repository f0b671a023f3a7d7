#include "csrbf/approx/samples/mapped_field.hpp"

#include "csrbf/linalg/decompositions.hpp"

namespace csrbf {

template <int Dim>
void MappedField<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  const Points<Dim> y = map_ * x;
  inner_->evaluate_block(y, out);
  for (Index i = 0; i < x.cols(); ++i) {
    if (out.gradient != nullptr) {
      Eigen::Map<Point<Dim>> gradient(out.gradient + Dim * i);
      gradient = (map_.transpose() * gradient).eval();
    }
    if (out.hessian == nullptr) continue;
    double* entry = out.hessian + symmetric_size<Dim> * i;
    Map H;
    for (int a = 0, k = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b, ++k) H(a, b) = H(b, a) = entry[k];
    H = (map_.transpose() * H * map_).eval();
    for (int a = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b) *entry++ = H(a, b);
  }
}

template <int Dim>
std::vector<Index> MappedField<Dim>::evaluation_order(const PointsRef<Dim>& x) const {
  const Points<Dim> y = map_ * x;
  return inner_->evaluation_order(y);
}

template <int Dim>
Box<Dim> MappedField<Dim>::bounds() const {
  const Box<Dim> box = inner_->bounds();
  const Map inverse = inverse_of(map_);
  const Point<Dim> center = inverse * box.center(), half = inverse.cwiseAbs() * (0.5 * box.extent());
  return {center - half, center + half};
}

#define CSRBF_INSTANTIATE(Dim) template class MappedField<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
