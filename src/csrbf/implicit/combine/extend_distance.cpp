#include "csrbf/implicit/combine/extend_distance.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/taylor.hpp"
#include "csrbf/implicit/mesh/triangle_tree.hpp"
#include "csrbf/implicit/polygonize.hpp"

namespace csrbf {
namespace {

// Chosen by hand: larger values are more accurate and slower.
constexpr double nodes_per_range = 4;   // of the lattice of the spline
constexpr double most_cells = 128;      // of that lattice along the longest side
constexpr int finest_resolution = 256;  // of the polygonization to which distances are measured

// The four cubic B-splines that are not zero at t in [0, 1] of a cell, and their derivatives.
struct Weights {
  Index first;  // node
  std::array<std::array<double, 4>, 3> of;
};

Weights weights_at(double x, int nodes, double inverse) {
  const double last = nodes - 3;  // the spline is defined from node 1 to node n - 2
  const double u = std::clamp(x - 1, 0.0, last);
  const double cell = std::min(std::floor(u), last - 1), t = u - cell, r = 1 - t;
  Weights w;
  w.first = static_cast<Index>(cell);
  w.of[0] = {r * r * r / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * r * r + 3 * r * r * r) / 6, t * t * t / 6};
  w.of[1] = {-r * r / 2, (-4 * t + 3 * t * t) / 2, (4 * r - 3 * r * r) / 2, t * t / 2};
  w.of[2] = {r, -2 + 3 * t, -2 + 3 * r, t};
  const double scale = u == x - 1 ? inverse : 0;  // constant outside
  for (std::size_t k = 0; k < 4; ++k) {
    w.of[1][k] *= scale;
    w.of[2][k] *= scale * scale;
  }
  return w;
}

// The spline with value, gradient and Hessian.
Taylor<3> spline_at(const ExtendedField::Data& data, const Point<3>& x) {
  std::array<Weights, 3> w;
  for (Index k = 0; k < 3; ++k)
    w[k] = weights_at((x[k] - data.origin[k]) / data.spacing, data.size[k], 1 / data.spacing);
  Taylor<3> sum;
  for (Index c = 0; c < 4; ++c)
    for (Index b = 0; b < 4; ++b)
      for (Index a = 0; a < 4; ++a) {
        const Index row = w[1].first + b, slice = w[2].first + c;
        const double node = data.lack[w[0].first + a + data.size[0] * (row + data.size[1] * slice)];
        const auto product = [&](std::size_t i, std::size_t j, std::size_t k) {
          return node * w[0].of[i][a] * w[1].of[j][b] * w[2].of[k][c];
        };
        sum.value += product(0, 0, 0);
        sum.gradient += Point<3>(product(1, 0, 0), product(0, 1, 0), product(0, 0, 1));
        sum.hessian(0, 0) += product(2, 0, 0);
        sum.hessian(1, 1) += product(0, 2, 0);
        sum.hessian(2, 2) += product(0, 0, 2);
        sum.hessian(0, 1) += product(1, 1, 0);
        sum.hessian(0, 2) += product(1, 0, 1);
        sum.hessian(1, 2) += product(0, 1, 1);
      }
  sum.hessian(1, 0) = sum.hessian(0, 1);
  sum.hessian(2, 0) = sum.hessian(0, 2);
  sum.hessian(2, 1) = sum.hessian(1, 2);
  return sum;
}

ExtendedField::Data make_lattice(const Box<3>& box, double range) {
  ExtendedField::Data data;
  const Box<3> reached = box.inflated(range);
  data.spacing = std::max(range / nodes_per_range, reached.extent().maxCoeff() / most_cells);
  // One more node on each side, which the spline needs.
  data.origin = reached.lo.array() - data.spacing;
  data.size = (reached.extent() / data.spacing).array().ceil().cast<int>() + 3;
  return data;
}

}  // namespace

void ExtendedField::evaluate_block(const PointsRef<3>& x, const JetBlock& out) const {
  data_.inner->evaluate_block(x, out);
  for (Index i = 0; i < x.cols(); ++i) {
    const double f = out.value[i];
    if (!(std::abs(f) > data_.near)) continue;
    Taylor<3> magnitude(std::abs(f));
    const double sign = f < 0 ? -1 : 1;
    if (out.gradient != nullptr) magnitude.gradient = sign * Eigen::Map<const Point<3>>(out.gradient + 3 * i);
    if (out.hessian != nullptr)
      for (int a = 0, entry = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b, ++entry)
          magnitude.hessian(a, b) = magnitude.hessian(b, a) = sign * out.hessian[6 * i + entry];
    const Taylor<3> trusted = smooth_step((1 / data_.near) * (magnitude - data_.near));
    const Taylor<3> extended = magnitude + trusted * spline_at(data_, x.col(i));
    out.value[i] = sign * extended.value;
    if (out.gradient != nullptr) Eigen::Map<Point<3>>(out.gradient + 3 * i) = sign * extended.gradient;
    if (out.hessian != nullptr)
      for (int a = 0, entry = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b, ++entry) out.hessian[6 * i + entry] = sign * extended.hessian(a, b);
  }
}

std::shared_ptr<const ExtendedField> extend_distance(const std::shared_ptr<const Field<3>>& field, double range,
                                                     const Progress& progress) {
  constexpr const char* f = "extend_distance";
  require(field != nullptr, f, "field", "null", "must point to a field");
  require(range > 0 && std::isfinite(range), f, "range", range, "must be positive and finite");
  require(field->feature_size() > 0, f, "feature_size of the field", field->feature_size(), "must be known");
  const int resolution = std::min(automatic_resolution(*field), finest_resolution);
  const Mesh mesh = polygonize(*field, {.resolution = resolution, .normals = false, .progress = progress});
  const TriangleTree surface(mesh);
  ExtendedField::Data data = make_lattice(surface.bounds(), range);
  data.inner = field;
  data.near = field->feature_size();
  data.lack.resize(data.size.cast<Index>().prod());
  const Index row = data.size[0], rows = data.lack.size() / row;
  constexpr Index rows_at_once = 1024;  // between two progress reports
  for (Index first = 0; first < rows; first += rows_at_once) {
    report(progress, "extend", static_cast<double>(first) / static_cast<double>(rows));
    parallel_for(std::min(rows_at_once, rows - first), 1, [&](Index begin, Index end) {
      Points<3> x(3, row);
      for (Index r = first + begin; r < first + end; ++r) {
        for (Index i = 0; i < row; ++i)
          x.col(i) =
              data.origin + data.spacing * Point<3>(static_cast<double>(i), static_cast<double>(r % data.size[1]),
                                                    static_cast<double>(r / data.size[1]));
        const Eigen::VectorXd value = field->evaluate(x).value;
        for (Index i = 0; i < row; ++i)
          data.lack[r * row + i] =
              static_cast<float>(std::max(0.0, surface.closest(x.col(i)).distance - std::abs(value[i])));
      }
    });
  }
  report(progress, "extend", 1);
  return std::make_shared<const ExtendedField>(std::move(data));
}

}  // namespace csrbf
