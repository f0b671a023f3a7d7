#include "csrbf/approx/basis/polynomial_block.hpp"

#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/spatial/chosen_points.hpp"

namespace csrbf {

template <int Dim>
PolynomialBlock<Dim> polynomial_block(const PointsRef<Dim>& points, int degree, RankDeficiency deficiency) {
  constexpr double dependent = 1e-10;  // coarser than the test of solve_saddle(), which then succeeds
  const Polynomials<Dim> polynomials(degree);
  const Index Q = polynomials.size();
  const Box<Dim> box = bounding_box<Dim>(points);
  PolynomialBlock<Dim> block;
  block.frame.degree = degree;
  block.frame.origin = box.center();
  const double half = .5 * box.extent().maxCoeff();
  block.frame.scale = half > 0 ? half : 1;
  block.G.resize(points.cols(), Q);
  if (Q == 0) {
    block.monomials.resize(0, 0);
    return block;
  }
  const Points<Dim> local = in_units<Dim>(points, block.frame.origin, block.frame.scale);
  polynomials.rows(local, block.G.data());
  Eigen::VectorXd norms = block.G.colwise().norm();
  for (double& norm : norms)
    if (!(norm > 0)) norm = 1;
  block.monomials = norms.cwiseInverse().asDiagonal();
  block.G *= block.monomials;
  if (deficiency == RankDeficiency::keep) return block;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(block.G);
  qr.setThreshold(dependent);
  if (qr.rank() == Q) return block;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(block.G, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Index rank = (svd.singularValues().array() > dependent * svd.singularValues()[0]).count();
  const Eigen::MatrixXd directions = svd.matrixV().leftCols(rank);
  block.G *= directions;
  block.monomials *= directions;
  return block;
}

#define CSRBF_INSTANTIATE(Dim) \
  template PolynomialBlock<Dim> polynomial_block<Dim>(const PointsRef<Dim>&, int, RankDeficiency);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
