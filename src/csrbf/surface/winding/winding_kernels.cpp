#include "csrbf/surface/winding/winding_kernels.hpp"

#include "csrbf/core/simd.hpp"

namespace csrbf::winding {
namespace {

constexpr float min_eps2 = 1e-10F;  // floor, in units of the cell: single precision holds its powers

// Per-lane sums.
struct LaneSums {
  alignas(64) float sum[10][lanes];
};

// Sample positions relative to x in units of the cell are (integer - base) * scale - shift.
struct Frame {
  std::int32_t base[3];
  float shift[3];
  float scale, eps_scale;
};

Frame make_frame(const Point<3>& x, double unit) {
  Frame frame;
  for (int k = 0; k < 3; ++k) {
    const double grid = x[k] * Tree::resolution;
    frame.base[k] = static_cast<std::int32_t>(grid);
    frame.shift[k] = static_cast<float>((grid - frame.base[k]) / (Tree::resolution * unit));
  }
  frame.scale = static_cast<float>(1 / (Tree::resolution * unit));
  frame.eps_scale = static_cast<float>(1 / (unit * unit));
  return frame;
}

// Adds sum m.r / D^(3/2), D = r^2 + eps^2, and its derivatives over samples begin, ..., begin + lanes; unless All,
// those from `count` on do not count.
template <int Order, bool All>
CSRBF_ALWAYS_INLINE void add_samples(const Tree& tree, std::int32_t begin, std::int32_t count, const Frame& frame,
                                     float (*__restrict sum)[lanes]) {
  const std::int32_t* px = tree.x[0].data() + begin;
  const std::int32_t* py = tree.x[1].data() + begin;
  const std::int32_t* pz = tree.x[2].data() + begin;
  const float* m0 = tree.strength[0].data() + begin;
  const float* m1 = tree.strength[1].data() + begin;
  const float* m2 = tree.strength[2].data() + begin;
  const float* e2 = tree.eps2.data() + begin;
  const std::int32_t bx = frame.base[0], by = frame.base[1], bz = frame.base[2];
  const float sx = frame.shift[0], sy = frame.shift[1], sz = frame.shift[2], scale = frame.scale,
              eps_scale = frame.eps_scale;
  for (int l = 0; l < lanes; ++l) {
    const float x = static_cast<float>(px[l] - bx) * scale - sx, y = static_cast<float>(py[l] - by) * scale - sy,
                z = static_cast<float>(pz[l] - bz) * scale - sz;
    const float eps2 = std::max(min_eps2, e2[l] * eps_scale);
    const float counts = All || l < count ? 1.0F : 0.0F;
    const float s = counts / std::sqrt(x * x + y * y + z * z + eps2), s2 = s * s, s3 = s2 * s;
    const float mr = m0[l] * x + m1[l] * y + m2[l] * z;
    sum[0][l] += mr * s3;
    if constexpr (Order >= 1) {
      const float t = 3 * mr * s2;
      sum[1][l] += s3 * (t * x - m0[l]);
      sum[2][l] += s3 * (t * y - m1[l]);
      sum[3][l] += s3 * (t * z - m2[l]);
      if constexpr (Order >= 2) {
        const float s5 = 3 * s3 * s2, t5 = 2.5F * mr * s2;
        const float gx = m0[l] - t5 * x, gy = m1[l] - t5 * y, gz = m2[l] - t5 * z;
        sum[4][l] -= s5 * (2 * gx * x + mr);
        sum[5][l] -= s5 * (gx * y + gy * x);
        sum[6][l] -= s5 * (gx * z + gz * x);
        sum[7][l] -= s5 * (2 * gy * y + mr);
        sum[8][l] -= s5 * (gy * z + gz * y);
        sum[9][l] -= s5 * (2 * gz * z + mr);
      }
    }
  }
}

// Adds the polynomial at t; lanes run over the exponents of y and z.
template <int Order>
CSRBF_ALWAYS_INLINE void add_polynomial(const Coefficients& far, const float* t, float (*__restrict sum)[lanes]) {
  // Powers of y and z: value, first and second derivative.
  float power[2][3][order];
  for (int axis = 0; axis < 2; ++axis) {
    const float v = t[axis + 1];
    const float p[3][order] = {{1, v, v * v, v * v * v}, {0, 1, 2 * v, 3 * v * v}, {0, 0, 2, 6 * v}};
    for (int d = 0; d <= Order; ++d) std::copy_n(p[d], order, power[axis][d]);
  }
  const float x = t[0];
  constexpr int y_order[6] = {0, 1, 0, 2, 1, 0}, z_order[6] = {0, 0, 1, 0, 1, 2};
  constexpr int combinations = Order == 0 ? 1 : Order == 1 ? 3 : 6;
  alignas(64) float yz[combinations][layer];
  for (int c = 0; c < combinations; ++c)
    for (int j = 0; j < order; ++j)
      for (int k = 0; k < order; ++k) yz[c][order * j + k] = power[0][y_order[c]][j] * power[1][z_order[c]][k];
  for (int first = 0; first < layer; first += lanes) {
    const float* c0 = far.data() + first;
    const float* c1 = c0 + layer;
    const float* c2 = c1 + layer;
    const float* c3 = c2 + layer;
    const float(*w)[layer] = yz;
    for (int l = 0; l < lanes; ++l) {
      const int m = first + l;
      const float f = c0[l] + x * (c1[l] + x * (c2[l] + x * c3[l]));
      sum[0][l] += f * w[0][m];
      if constexpr (Order >= 1) {
        const float fx = c1[l] + x * (2 * c2[l] + 3 * x * c3[l]);
        sum[1][l] += fx * w[0][m];
        sum[2][l] += f * w[1][m];
        sum[3][l] += f * w[2][m];
        if constexpr (Order >= 2) {
          sum[4][l] += (2 * c2[l] + 6 * x * c3[l]) * w[0][m];
          sum[5][l] += fx * w[1][m];
          sum[6][l] += fx * w[2][m];
          sum[7][l] += f * w[3][m];
          sum[8][l] += f * w[4][m];
          sum[9][l] += f * w[5][m];
        }
      }
    }
  }
}

template <int Order>
CSRBF_ALWAYS_INLINE void sum_cell(const Tree& tree, const Cell& cell, const Frame& frame, const float* t,
                                  LaneSums& near, LaneSums& far) {
  constexpr int terms = Order == 0 ? 1 : Order == 1 ? 4 : 10;
  for (int k = 0; k < terms; ++k)
    for (int l = 0; l < lanes; ++l) near.sum[k][l] = far.sum[k][l] = 0;
  for (const Range& range : cell.near) {
    std::int32_t i = range.begin;
    for (; i + lanes <= range.end; i += lanes) add_samples<Order, true>(tree, i, lanes, frame, near.sum);
    if (i < range.end) add_samples<Order, false>(tree, i, range.end - i, frame, near.sum);
  }
  add_polynomial<Order>(cell.far, t, far.sum);
}

// Points relative to one of them, in single precision: mixed with double, loops take half as many at a time.
struct Steps {
  Point<3> from;
  alignas(64) float x[3][layer];
};

CSRBF_ALWAYS_INLINE Steps steps_of(const Layer& at) {
  Steps steps{Point<3>(at.x[0][0], at.x[1][0], at.x[2][0]), {}};
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < layer; ++l) steps.x[k][l] = static_cast<float>(at.x[k][l] - at.x[k][0]);
  return steps;
}

// Adds the expansion of a node: sum_m P_m(r) D^(-m/2), m = 3, 5, 7, D = r^2 + eps^2, r = center - x.
CSRBF_ALWAYS_INLINE void add_expansion(const Node& node, const Steps& steps, float* __restrict sum) {
  const float n0 = node.dipole[0], n1 = node.dipole[1], n2 = node.dipole[2], eps2 = node.eps2;
  const float axx = node.quadratic[0], axy = node.quadratic[1], axz = node.quadratic[2], ayy = node.quadratic[3],
              ayz = node.quadratic[4], azz = node.quadratic[5];
  const float q0 = node.cubic[0], q1 = node.cubic[1], q2 = node.cubic[2], q3 = node.cubic[3], q4 = node.cubic[4],
              q5 = node.cubic[5], q6 = node.cubic[6], q7 = node.cubic[7], q8 = node.cubic[8], q9 = node.cubic[9];
  const float trace = -(axx + ayy + azz) / 3;
  const float b0 = -0.6F * q0 - 0.2F * (q3 + q5), b1 = -0.6F * q6 - 0.2F * (q1 + q8),
              b2 = -0.6F * q9 - 0.2F * (q2 + q7);
  float first[3];
  for (int k = 0; k < 3; ++k) first[k] = static_cast<float>((node.center[k] - steps.from[k]) * node.inverse_scale);
  const float x0 = first[0], y0 = first[1], z0 = first[2], scale = static_cast<float>(node.inverse_scale);
  for (int l = 0; l < layer; ++l) {
    const float x = x0 - scale * steps.x[0][l], y = y0 - scale * steps.x[1][l], z = z0 - scale * steps.x[2][l];
    const float s = 1 / std::sqrt(x * x + y * y + z * z + eps2), s2 = s * s;
    const float P3 = n0 * x + n1 * y + n2 * z + trace;
    const float P5 = x * (axx * x + axy * y + axz * z + b0) + y * (ayy * y + ayz * z + b1) + z * (azz * z + b2);
    const float P7 = x * (x * (q0 * x + q1 * y + q2 * z) + y * (q3 * y + q4 * z) + q5 * z * z) +
                     y * (y * (q6 * y + q7 * z) + q8 * z * z) + q9 * z * z * z;
    sum[l] += s * s2 * (P3 + s2 * (P5 + s2 * P7));
  }
}

// Adds the samples of a node.
CSRBF_ALWAYS_INLINE void add_leaf(const Tree& tree, const Node& node, const Layer& at, float* __restrict sum) {
  const double scale = node.inverse_scale;
  alignas(64) float x[3][layer];
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < layer; ++l) x[k][l] = static_cast<float>((at.x[k][l] - node.center[k]) * scale);
  const auto strength_scale = static_cast<float>(scale * scale);
  for (std::int32_t i = node.begin; i < node.begin + node.count; ++i) {
    float p[3], m[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = static_cast<float>((tree.x[k].data()[i] / Tree::resolution - node.center[k]) * scale);
      m[k] = tree.strength[k].data()[i] * strength_scale;
    }
    const float px = p[0], py = p[1], pz = p[2], mx = m[0], my = m[1], mz = m[2],
                eps2 = tree.eps2.data()[i] * strength_scale;
    for (int l = 0; l < layer; ++l) {
      const float rx = px - x[0][l], ry = py - x[1][l], rz = pz - x[2][l];
      const float s = 1 / std::sqrt(rx * rx + ry * ry + rz * rz + eps2);
      sum[l] += (mx * rx + my * ry + mz * rz) * s * s * s;
    }
  }
}

double total(const float* sum) {
  double result = 0;
  for (int l = 0; l < lanes; ++l) result += sum[l];
  return result;
}

CSRBF_ALWAYS_INLINE void add_layer(const Tree& tree, std::span<const std::int32_t> nodes,
                                   std::span<const std::int32_t> leaves, Layer& at) {
  const Steps steps = steps_of(at);
  for (const std::int32_t id : nodes) add_expansion(tree.nodes.data()[id], steps, at.sum);
  for (const std::int32_t id : leaves) add_leaf(tree, tree.nodes.data()[id], at, at.sum);
}

}  // namespace

Sums sum_cell(const Tree& tree, const Cell& cell, const Point<3>& x, Derivatives derivatives) {
  const Frame frame = make_frame(x, cell.half);
  const Eigen::Vector3f t = ((x - cell.center) / cell.half).cast<float>();
  LaneSums near, far;
  if (derivatives == Derivatives::none) simd<sum_cell<0>>(tree, cell, frame, t.data(), near, far);
  if (derivatives == Derivatives::gradient) simd<sum_cell<1>>(tree, cell, frame, t.data(), near, far);
  if (derivatives == Derivatives::hessian) simd<sum_cell<2>>(tree, cell, frame, t.data(), near, far);
  Sums sums{};
  const int count = derivatives == Derivatives::none ? 1 : derivatives == Derivatives::gradient ? 4 : 10;
  const double inverse = 1 / cell.half;
  for (int k = 0; k < count; ++k) {
    const double unit = k == 0 ? 1 : k < 4 ? inverse : inverse * inverse;
    sums[k] = unit * (total(far.sum[k]) + inverse * inverse * total(near.sum[k]));
  }
  return sums;
}

void add_sources(const Tree& tree, std::span<const std::int32_t> nodes, std::span<const std::int32_t> leaves,
                 Layer& at) {
  simd<add_layer>(tree, nodes, leaves, at);
}

}  // namespace csrbf::winding
