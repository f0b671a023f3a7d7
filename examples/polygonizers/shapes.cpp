#include "shapes.hpp"

#include <Eigen/Geometry>

#include <functional>

namespace {

using csrbf::Box;
using csrbf::Index;
using csrbf::Point;
using csrbf::Points;

/// A field given by a function that returns the value and fills the gradient.
class GivenField final : public csrbf::Field<3> {
 public:
  using Function = std::function<double(const Point<3>& p, Point<3>& gradient)>;

  GivenField(Function function, const Box<3>& bounds, Points<3> seeds)
      : function_(std::move(function)), bounds_(bounds), seeds_(std::move(seeds)) {}

  void evaluate_block(const csrbf::PointsRef<3>& x, const csrbf::JetBlock& out) const override {
    Point<3> gradient;
    for (Index i = 0; i < x.cols(); ++i) {
      out.value[i] = function_(x.col(i), gradient);
      if (out.gradient != nullptr) Eigen::Map<Point<3>>(out.gradient + 3 * i) = gradient;
    }
  }
  [[nodiscard]] Box<3> bounds() const override { return bounds_; }
  [[nodiscard]] Points<3> seeds() const override { return seeds_; }

 private:
  Function function_;
  Box<3> bounds_;
  Points<3> seeds_;
};

Points<3> columns(const std::vector<Point<3>>& points) {
  Points<3> result(3, static_cast<Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) result.col(static_cast<Index>(i)) = points[i];
  return result;
}

std::shared_ptr<const GivenField> torus(double major, double minor) {
  return std::make_shared<GivenField>(
      [=](const Point<3>& p, Point<3>& g) {
        const double q = std::hypot(p[0], p[1]), tube = std::hypot(q - major, p[2]);
        g = -Point<3>((q - major) * p[0] / q, (q - major) * p[1] / q, p[2]) / tube;
        return minor - tube;
      },
      Box<3>{{-major - minor, -major - minor, -minor}, {major + minor, major + minor, minor}},
      columns({{major + minor, 0, 0}}));
}

// (x (x - 1)^2 (x - 2) + y^2)^2 + z^2 = 1/50.
std::shared_ptr<const GivenField> double_torus() {
  return std::make_shared<GivenField>(
      [](const Point<3>& p, Point<3>& g) {
        const double x = p[0], a = x * (x - 1) * (x - 1) * (x - 2) + p[1] * p[1];
        const double slope = (x - 1) * (x - 1) * (x - 2) + 2 * x * (x - 1) * (x - 2) + x * (x - 1) * (x - 1);
        g = Point<3>(-2 * a * slope, -4 * a * p[1], -2 * p[2]);
        return 0.02 - a * a - p[2] * p[2];
      },
      Box<3>{{-0.15, -0.75, -0.15}, {2.15, 0.75, 0.15}}, columns({{1, 0, 0.14}}));
}

std::shared_ptr<const GivenField> touching_balls() {
  const std::vector<Point<3>> centers{{-1, 0, 0}, {1, 0, 0}, {0, std::sqrt(3.0), 0}};
  return std::make_shared<GivenField>(
      [=](const Point<3>& p, Point<3>& g) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Point<3>& center : centers) {
          const double r = (p - center).norm();
          if (!(r < nearest)) continue;
          nearest = r;
          g = (center - p) / r;
        }
        return 1 - nearest;
      },
      Box<3>{{-2, -1, -1}, {2, 1 + std::sqrt(3.0), 1}}, columns({{-2, 0, 0}, {2, 0, 0}, {0, 1 + std::sqrt(3.0), 0}}));
}

std::shared_ptr<const GivenField> shell(double thickness) {
  return std::make_shared<GivenField>(
      [=](const Point<3>& p, Point<3>& g) {
        const double r = p.norm(), outside = 1 - r, inside = r - 1 + thickness;
        g = (outside < inside ? -1 : 1) * p / r;
        return std::min(outside, inside);
      },
      Box<3>{Point<3>::Constant(-1), Point<3>::Constant(1)}, columns({{1, 0, 0}, {0, 0, -1 + thickness}}));
}

std::shared_ptr<const GivenField> box(const Point<3>& half) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Point<3>(1, 2, 3).normalized()).toRotationMatrix();
  return std::make_shared<GivenField>(
      [=](const Point<3>& p, Point<3>& g) {
        const Point<3> q = turn.transpose() * p;
        Index axis = 0;
        const double f = (half - q.cwiseAbs()).minCoeff(&axis);
        g = -std::copysign(1.0, q[axis]) * turn.col(axis);
        return f;
      },
      Box<3>{Point<3>::Constant(-half.norm()), Point<3>::Constant(half.norm())}, columns({turn.col(0) * half[0]}));
}

}  // namespace

std::vector<Shape> make_shapes(int resolution) {
  return {{"torus", torus(1, 0.4), 0},
          {"double torus", double_torus(), -2},
          {"touching balls", touching_balls(), std::nullopt},
          {"thin shell", shell(2 * 2.0 / resolution), 4},
          {"sharp box", box({0.7, 0.5, 0.4}), 2}};
}
