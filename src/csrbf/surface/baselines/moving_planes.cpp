#include "csrbf/core/parallel.hpp"
#include "csrbf/core/small_matrices.hpp"
#include "csrbf/surface/baselines/baselines.hpp"

#include <Eigen/Geometry>

#include <utility>

namespace csrbf::baselines {
namespace {

// Chosen by hand.
constexpr double difference_step = 1e-3;  // spacings, of finite differences: truncation against rounding
constexpr Index plane_neighbors = 12;     // of Hoppe's tangent planes; more: smoother
constexpr Index neighbors = 24;           // of the moving methods; a quadratic polynomial has 6 coefficients
constexpr int projection_steps = 3;       // of the fixed-point iteration for the foot of a point
constexpr double projection_reach = 3;    // spacings from the samples within which points are projected

// A field given by values only; derivatives are central differences.
class ValueField : public Field<3> {
 public:
  explicit ValueField(const PreparedCloud& cloud)
      : bounds_(bounding_box<3>(cloud.cloud.points)), step_(difference_step * cloud.cloud.spacing.mean()) {}

  [[nodiscard]] virtual double value(const Point<3>& x) const = 0;

  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<3> bounds() const override { return bounds_; }

 private:
  Box<3> bounds_;
  double step_;  // half the width of the differences
};

void ValueField::evaluate_block(const PointsRef<3>& x, const JetBlock& out) const {
  const auto at = [&](const Point<3>& p, int a, double i, int b, double j) {
    return value(p + step_ * (i * Point<3>::Unit(a) + j * Point<3>::Unit(b)));
  };
  for (Index k = 0; k < x.cols(); ++k) {
    const Point<3> p = x.col(k);
    const double f = out.value[k] = value(p);
    if (out.gradient == nullptr) continue;
    for (int a = 0, entry = 0; a < 3; ++a) {
      const double up = at(p, a, 1, a, 0), down = at(p, a, -1, a, 0);
      out.gradient[3 * k + a] = (up - down) / (2 * step_);
      if (out.hessian == nullptr) continue;
      out.hessian[6 * k + entry++] = (up - 2 * f + down) / (step_ * step_);
      for (int b = a + 1; b < 3; ++b, ++entry)
        out.hessian[6 * k + entry] =
            (at(p, a, 1, b, 1) - at(p, a, 1, b, -1) - at(p, a, -1, b, 1) + at(p, a, -1, b, -1)) / (4 * step_ * step_);
    }
  }
}

// The points and normals of a cloud with a tree.
class PlaneSamples {
 public:
  PlaneSamples(Points<3> points, Points<3> normals)
      : points_(std::move(points)), normals_(std::move(normals)), tree_(points_) {}

 protected:
  Points<3> points_, normals_;
  KdTree<3> tree_;
};

class Hoppe final : public ValueField, private PlaneSamples {
 public:
  Hoppe(const PreparedCloud& cloud, Points<3> origins)
      : ValueField(cloud), PlaneSamples(std::move(origins), cloud.cloud.normals) {}

  [[nodiscard]] double value(const Point<3>& x) const override {
    Index i = 0;
    double squared = 0;
    tree_.nearest(x, 1, &i, &squared);
    return -normals_.col(i).dot(x - points_.col(i));
  }
};

// Neighbours of a point with weights that vanish at the farthest one.
struct Neighborhood {
  Index count = 0;
  std::array<Index, neighbors> ids{};
  std::array<double, neighbors> squared{};
  std::array<double, neighbors> weight{};
  double radius = 0;
  Point<3> position = Point<3>::Zero();  // weighted mean
  Point<3> normal = Point<3>::Zero();    // likewise, unit
};

class MovingPlanes : public ValueField, protected PlaneSamples {
 public:
  explicit MovingPlanes(const PreparedCloud& cloud)
      : ValueField(cloud), PlaneSamples(cloud.cloud.points, cloud.cloud.normals) {}

  [[nodiscard]] double value(const Point<3>& x) const override {
    const Neighborhood near = around(x);
    return near.normal.dot(near.position - x);
  }

 protected:
  [[nodiscard]] Neighborhood around(const Point<3>& x) const {
    Neighborhood near;
    near.count = tree_.nearest(x, neighbors, near.ids.data(), near.squared.data());
    if (near.count == 0) {  // x is not a number
      near.position = x;
      return near;
    }
    near.radius = std::sqrt(near.squared[near.count - 1]);
    double sum = 0;
    for (Index k = 0; k < near.count; ++k) {
      // Far from the surface all distances are similar, so weights depend on their excess over the smallest.
      const double t = (std::sqrt(near.squared[k]) - std::sqrt(near.squared[0])) /
                       (near.radius - std::sqrt(near.squared[0]) + 1e-300);
      near.weight[k] = (1 - t * t) * (1 - t * t);
      sum += near.weight[k];
      near.position += near.weight[k] * points_.col(near.ids[k]);
      near.normal += near.weight[k] * normals_.col(near.ids[k]);
    }
    near.position /= sum;
    near.normal.normalize();
    return near;
  }
};

class ProjectionMls final : public MovingPlanes {
 public:
  explicit ProjectionMls(const PreparedCloud& cloud)
      : MovingPlanes(cloud), reach_(projection_reach * cloud.cloud.spacing.mean()) {}

  // Distance to h(u, v) over the plane at the mean of the neighbours of the foot of x, found iteratively. Far from the
  // samples, where there is no projection, distance to the moving plane.
  [[nodiscard]] double value(const Point<3>& x) const override {
    Neighborhood near = around(x);
    if (near.squared[0] > reach_ * reach_) return near.normal.dot(near.position - x);
    Point<3> foot = x;
    double distance = 0;
    for (int k = 0; k < projection_steps; ++k) {
      if (k > 0) near = around(foot);
      if (near.normal.isZero(0)) break;  // normals that cancel, or are not known, leave no plane to project on
      distance = near.normal.dot(x - near.position) - height(near, x);
      foot = x - distance * near.normal;
    }
    return -distance;
  }

 private:
  // Height of the quadratic polynomial above the foot of x.
  [[nodiscard]] double height(const Neighborhood& near, const Point<3>& x) const {
    const Point<3> u = near.normal.unitOrthogonal(), v = near.normal.cross(u);
    using Column = Eigen::Matrix<double, 6, 1>;
    Eigen::Matrix<double, 6, 6> M = 1e-9 * Eigen::Matrix<double, 6, 6>::Identity();
    Column b = Column::Zero();
    const auto monomials = [&](const Point<3>& p) {
      const double s = u.dot(p - near.position) / near.radius, t = v.dot(p - near.position) / near.radius;
      return Column{1, s, t, s * s, s * t, t * t};
    };
    for (Index k = 0; k < near.count; ++k) {
      const Point<3> p = points_.col(near.ids[k]);
      const Column m = monomials(p);
      M += near.weight[k] * m * m.transpose();
      b += near.weight[k] * near.normal.dot(p - near.position) * m;
    }
    return solve_symmetric(M, b).dot(monomials(x));
  }

  double reach_;
};

}  // namespace

MethodFit hoppe(const PreparedCloud& cloud, const MethodOptions& /*options*/) {
  const Points<3>& points = cloud.cloud.points;
  Points<3> origins(3, points.cols());
  parallel_for(points.cols(), 256, [&](Index begin, Index end) {
    std::array<Index, plane_neighbors> ids;
    std::array<double, plane_neighbors> squared;
    for (Index i = begin; i < end; ++i) {
      const Index found = cloud.tree->nearest(points.col(i), plane_neighbors, ids.data(), squared.data());
      Point<3> sum = Point<3>::Zero();
      for (Index k = 0; k < found; ++k) sum += points.col(ids[k]);
      origins.col(i) = sum / static_cast<double>(found);
    }
  });
  return {std::make_shared<const Hoppe>(cloud, std::move(origins)), points.cols(), 0};
}

MethodFit adamson_alexa(const PreparedCloud& cloud, const MethodOptions& /*options*/) {
  return {std::make_shared<const MovingPlanes>(cloud), cloud.cloud.size(), 0};
}

MethodFit projection_mls(const PreparedCloud& cloud, const MethodOptions& /*options*/) {
  return {std::make_shared<const ProjectionMls>(cloud), cloud.cloud.size(), 0};
}

}  // namespace csrbf::baselines
