#pragma once

#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/medial/ball_tree.hpp"

namespace csrbf::baselines {

/// Sums over balls with quadrics (see BallTree): `constant` + sum phi g, or normalised sum phi g / sum phi, which
/// outside all balls is the quadric of the nearest centre.
class QuadricBalls final : public Field<3> {
 public:
  struct Data {
    Points<3> centers{3, 0};
    Eigen::VectorXd supports;
    BallTree::Quadrics quadrics{10, 0};
    bool normalized = true;
    double constant = 0;
  };

  explicit QuadricBalls(Data data);

  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<3> bounds() const override { return bounding_box<3>(data_.centers); }

  [[nodiscard]] const Data& data() const { return data_; }

 private:
  [[nodiscard]] Taylor<3> nearest_quadric(const Point<3>& x) const;

  Data data_;
  BallTree balls_;
  KdTree<3> tree_;
};

/// Collects balls one by one.
class BallBuilder {
 public:
  void add(const Point<3>& center, double support, const Eigen::Matrix<double, 10, 1>& quadric);
  [[nodiscard]] QuadricBalls::Data data() const;

 private:
  std::vector<Point<3>> centers_;
  std::vector<double> supports_;
  std::vector<Eigen::Matrix<double, 10, 1>> quadrics_;
};

}  // namespace csrbf::baselines
