#include "csrbf/surface/baselines/quadric_balls.hpp"

#include "csrbf/surface/medial/quadric_fitter.hpp"

#include <utility>

namespace csrbf::baselines {

QuadricBalls::QuadricBalls(Data data)
    : data_(std::move(data)), balls_(data_.centers, data_.supports, data_.quadrics), tree_(data_.centers) {}

Taylor<3> QuadricBalls::nearest_quadric(const Point<3>& x) const {
  Index i = 0;
  double squared = 0;
  tree_.nearest(x, 1, &i, &squared);
  const auto& c = data_.quadrics.col(i);
  const Eigen::Vector4d value = evaluate_quadric(c, x - data_.centers.col(i));
  Taylor<3> f(value[0]);
  f.gradient = value.tail<3>();
  f.hessian << c[4], c[5], c[6], c[5], c[7], c[8], c[6], c[8], c[9];
  f.hessian *= 2;
  return f;
}

void QuadricBalls::evaluate_block(const PointsRef<3>& x, const JetBlock& out) const {
  BallTree::Runs runs;
  BallSums sums;
  for (Index i = 0; i < x.cols(); ++i) {
    balls_.sum(x.col(i), out.derivatives(), runs, sums);
    Taylor<3> f = total<Taylor<3>>(sums.S, out.derivatives());
    if (data_.normalized) {
      const Taylor<3> W = total<Taylor<3>>(sums.W, out.derivatives());
      f = W.value > 0 ? f / W : nearest_quadric(x.col(i));
    }
    f.value += data_.constant;
    store(f, i, out);
  }
}

void BallBuilder::add(const Point<3>& center, double support, const Eigen::Matrix<double, 10, 1>& quadric) {
  centers_.push_back(center);
  supports_.push_back(support);
  quadrics_.push_back(quadric);
}

QuadricBalls::Data BallBuilder::data() const {
  const Index n = std::ssize(supports_);
  QuadricBalls::Data data{Points<3>(3, n), Eigen::VectorXd(n), BallTree::Quadrics(10, n)};
  for (Index i = 0; i < n; ++i) {
    data.centers.col(i) = centers_[i];
    data.supports[i] = supports_[i];
    data.quadrics.col(i) = quadrics_[i];
  }
  return data;
}

}  // namespace csrbf::baselines
