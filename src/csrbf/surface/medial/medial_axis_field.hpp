#pragma once

#include "csrbf/surface/medial/ball_tree.hpp"
#include "csrbf/surface/winding/winding_number.hpp"

namespace csrbf {

/// An implicit surface of balls, each with a quadric (thesis section 6.2, eq. (6.18) in its normalised form): near the
/// data
///
///     f(x) = sum_i phi(|x - c_i| / sigma_i) g_i(x) / sum_i phi(|x - c_i| / sigma_i),
///     g_i(x) = b0 + b . d + d^T A d,  d = x - c_i,
///
/// with Wendland's C2 function phi; the coefficients alpha_i of the thesis are part of b0. Outside the balls, and where
/// it is unambiguous, the winding number of the centres gives the sign; the transitions are C2, so that value, gradient
/// and Hessian are continuous.
class MedialAxisField final : public Field<3> {
 public:
  struct Data {
    Points<3> centers;
    Eigen::VectorXd supports;  ///< sigma_i
    BallTree::Quadrics quadrics;
    WindingNumber winding;  ///< of the centres
    double far_value = 0;   ///< |f| far from the data
  };

  explicit MedialAxisField(Data data);

  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override;
  /// Bounding box of the centres.
  [[nodiscard]] Box<3> bounds() const override { return bounding_box<3>(data_.centers); }
  /// The centres.
  [[nodiscard]] Points<3> seeds() const override { return data_.centers; }

  [[nodiscard]] const Data& data() const { return data_; }

 private:
  template <class Scalar>
  void blend(const Jet<3>& winding, const BallSums& sums, Index i, const JetBlock& out) const;

  Data data_;
  BallTree balls_;
};

}  // namespace csrbf
