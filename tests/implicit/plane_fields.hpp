#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/taylor.hpp"

#include <functional>

// Fields of the plane in closed form with exact derivatives.
namespace csrbf {

/// A field given by an expression in the two coordinates.
class PlaneField : public Field<2> {
 public:
  using Variable = Taylor<2>;
  using Expression = std::function<Taylor<2>(const Variable& x, const Variable& y)>;

  PlaneField(Expression expression, const Box<2>& bounds, double feature_size = 0)
      : expression_(std::move(expression)), bounds_(bounds), feature_size_(feature_size) {}

  void evaluate_block(const PointsRef<2>& p, const JetBlock& out) const override {
    for (Index i = 0; i < p.cols(); ++i) {
      std::array<Variable, 2> x;
      for (Index k = 0; k < 2; ++k) {
        x[k].value = p(k, i);
        x[k].gradient[k] = 1;
      }
      const Taylor<2> f = expression_(x[0], x[1]);
      out.value[i] = f.value;
      if (out.gradient != nullptr) Eigen::Map<Point<2>>(out.gradient + 2 * i) = f.gradient;
    }
  }
  [[nodiscard]] Box<2> bounds() const override { return bounds_; }
  [[nodiscard]] double feature_size() const override { return feature_size_; }

 private:
  Expression expression_;
  Box<2> bounds_;
  double feature_size_;
};

inline Box<2> square_box(double half) {
  return {Point<2>::Constant(-half), Point<2>::Constant(half)};
}

/// 1 - (x - cx)^2 / a^2 - (y - cy)^2 / b^2.
inline PlaneField ellipse(double a, double b, const Box<2>& bounds, const Point<2>& c = Point<2>::Zero()) {
  return {[=](const Taylor<2>& x, const Taylor<2>& y) {
            const Taylor<2> u = (1 / a) * (x - c[0]), v = (1 / b) * (y - c[1]);
            return 1.0 - u * u - v * v;
          },
          bounds};
}

/// Between the circles of radii `inner` and `outer` around c.
inline PlaneField ring(double inner, double outer, const Box<2>& bounds, const Point<2>& c = Point<2>::Zero()) {
  return {[=](const Taylor<2>& x, const Taylor<2>& y) {
            const Taylor<2> s = (x - c[0]) * (x - c[0]) + (y - c[1]) * (y - c[1]);
            return (outer * outer - s) * (s - inner * inner);
          },
          bounds};
}

}  // namespace csrbf
