#pragma once

#include "csrbf/approx/basis/polynomial.hpp"
#include "csrbf/approx/basis/support_tree.hpp"
#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/kernels/kernel.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <memory>
#include <utility>
#include <vector>

namespace csrbf {

/// See moving_least_squares().
template <int Dim>
class MovingLeastSquares : public Field<Dim> {
 public:
  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<Dim> bounds() const override;

  struct Data;
  MovingLeastSquares(std::shared_ptr<const Data> data, Index component);

  [[nodiscard]] const Data& data() const { return *data_; }
  [[nodiscard]] Index component() const { return component_; }

 private:
  std::shared_ptr<const Data> data_;
  Index component_;
};

/// Data shared by the fields of all components.
template <int Dim>
struct MovingLeastSquares<Dim>::Data {
  Samples<Dim> samples;  ///< at distinct points
  Kernel kernel;
  Eigen::VectorXd radii;                ///< of the weights
  Points<Dim> directions{Dim, 0};       ///< of the tracks, or none
  std::vector<Polynomials<Dim>> bases;  ///< of degree 0, 1, ...
  KdTree<Dim> nearest;
  SupportTree<Dim> supports;

  Data(Samples<Dim> s, const Kernel& k, int degree) : samples(std::move(s)), kernel(k), nearest(samples.points) {
    for (int d = 0; d <= degree; ++d) bases.emplace_back(d);
  }
  void set_radii(Eigen::VectorXd values) {
    radii = std::move(values);
    supports = SupportTree<Dim>(samples.points, radii);
  }
};

}  // namespace csrbf
