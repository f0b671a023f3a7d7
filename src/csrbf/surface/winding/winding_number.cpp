#include "csrbf/surface/winding/winding_number.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/taylor.hpp"
#include "csrbf/surface/winding/winding_cubes.hpp"

#include <utility>

namespace csrbf {
namespace {

constexpr double horizon = 1e9;  // extents of the samples; points farther away are clamped to it: u is -1 anyway

void check(const winding::SamplesRef& data) {
  constexpr auto where = "WindingNumber";
  const Index n = data.points.cols();
  require(data.normals.cols() == n, where, "normals.cols()", data.normals.cols(), "must be the number of points");
  require(data.areas.size() == n, where, "areas.size()", data.areas.size(), "must be the number of points");
  require(data.eps.size() == n, where, "eps.size()", data.eps.size(), "must be the number of points");
  require(std::int64_t{n} < (std::int64_t{1} << 31) - winding::lanes, where, "points.cols()", n, "must be below 2^31");
  if (n == 0) return;
  require(data.points.allFinite(), where, "points", "NaN or infinity", "must be finite; remove such points");
  require(data.normals.allFinite(), where, "normals", "NaN or infinity", "must be finite; set unknown normals to zero");
  require(data.areas.allFinite() && data.areas.minCoeff() >= 0, where, "areas.minCoeff()", data.areas.minCoeff(),
          "areas must be finite and not negative");
  require(data.eps.allFinite() && data.eps.minCoeff() > 0, where, "eps.minCoeff()", data.eps.minCoeff(),
          "smoothing lengths must be finite and positive");
}

// The expansion of a node at a distant point, lengths in units of the tree.
winding::Sums sum_node(const winding::Node& node, const Point<3>& x) {
  Taylor<3> r[3], D(node.eps2), N, A, Q;
  for (int k = 0; k < 3; ++k) {
    r[k].value = (node.center[k] - x[k]) * node.inverse_scale;
    r[k].gradient[k] = -node.inverse_scale;
    D = D + r[k] * r[k];
    N = N + double{node.dipole[k]} * r[k];
  }
  for (int i = 0, a = 0, q = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j, ++a) {
      const Taylor<3> rr = r[i] * r[j];
      A = A + double{node.quadratic[a]} * rr;
      for (int k = j; k < 3; ++k, ++q) Q = Q + double{node.cubic[q]} * (rr * r[k]);
    }
  const double trace = -(node.quadratic[0] + node.quadratic[3] + node.quadratic[5]) / 3.0;
  const float* q = node.cubic;
  const double b[3] = {-0.6 * q[0] - 0.2 * (q[3] + q[5]), -0.6 * q[6] - 0.2 * (q[1] + q[8]),
                       -0.6 * q[9] - 0.2 * (q[2] + q[7])};
  for (int k = 0; k < 3; ++k) A = A + b[k] * r[k];
  const double s = 1 / std::sqrt(D.value);
  const Taylor<3> inverse = 1.0 / D, s3 = inverse * apply(D, s, -0.5 * s / D.value, 0.75 * s / (D.value * D.value));
  const Taylor<3> f = s3 * (N + trace + inverse * (A + inverse * Q));
  return {f.value,         f.gradient[0],   f.gradient[1],   f.gradient[2],   f.hessian(0, 0),
          f.hessian(0, 1), f.hessian(0, 2), f.hessian(1, 1), f.hessian(1, 2), f.hessian(2, 2)};
}

}  // namespace

struct WindingNumber::Impl {
  winding::Tree tree;
  winding::Cubes cubes;

  explicit Impl(winding::Tree made) : tree(std::move(made)), cubes(tree) {}
  Impl(winding::Tree made, const winding::MadeCubes& parts) : tree(std::move(made)), cubes(tree, parts) {}
};

WindingNumber::WindingNumber(const Data& data) : WindingNumber(data.points, data.normals, data.areas, data.eps) {}

WindingNumber::WindingNumber(const PointsRef<3>& points, const PointsRef<3>& normals,
                             const Eigen::Ref<const Eigen::VectorXd>& areas,
                             const Eigen::Ref<const Eigen::VectorXd>& eps) {
  const winding::SamplesRef data{points, normals, areas, eps};
  check(data);
  if (points.cols() > 0) impl_ = std::make_shared<const Impl>(winding::make_tree(data));
}

WindingNumber::WindingNumber(winding::Tree tree) {
  if (!tree.nodes.empty()) impl_ = std::make_shared<const Impl>(std::move(tree));
}

WindingNumber::WindingNumber(winding::Tree tree, const winding::MadeCubes& cubes) {
  if (!tree.nodes.empty()) impl_ = std::make_shared<const Impl>(std::move(tree), cubes);
}

winding::MadeCubes WindingNumber::made_cubes() const {
  return impl_ ? impl_->cubes.made() : winding::MadeCubes{};
}

const winding::Tree& WindingNumber::tree() const {
  static const winding::Tree none;
  return impl_ ? impl_->tree : none;
}

WindingNumber::Data WindingNumber::data() const {
  return impl_ ? winding::samples_of(impl_->tree) : Data{};
}

Points<3> WindingNumber::seeds() const {
  return impl_ ? impl_->tree.points : Points<3>(3, 0);
}

Box<3> WindingNumber::bounds() const {
  return impl_ ? bounding_box<3>(impl_->tree.points) : Box<3>{};
}

void WindingNumber::evaluate_block(const PointsRef<3>& x, const JetBlock& out) const {
  const winding::Cell* cell = nullptr;
  for (Index i = 0; i < x.cols(); ++i) {
    winding::Sums sums{};
    double unit = 1;
    if (impl_) {
      const winding::Tree& tree = impl_->tree;
      unit = tree.unit;
      const Point<3> y = ((x.col(i) - tree.origin) / unit).cwiseMax(-horizon).cwiseMin(horizon);
      if (cell == nullptr || !cell->contains(y)) cell = impl_->cubes.find(y);
      sums = cell != nullptr ? sum_cell(tree, *cell, y, out.derivatives()) : sum_node(tree.nodes.front(), y);
    }
    out.value[i] = sums[0] - 1;
    if (out.gradient != nullptr)
      for (Index k = 0; k < 3; ++k) out.gradient[3 * i + k] = sums[1 + k] / unit;
    if (out.hessian != nullptr)
      for (Index k = 0; k < 6; ++k) out.hessian[6 * i + k] = sums[4 + k] / unit / unit;
  }
}

}  // namespace csrbf
