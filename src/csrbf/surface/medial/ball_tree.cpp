#include "csrbf/surface/medial/ball_tree.hpp"

#include "csrbf/core/simd.hpp"

#include <type_traits>

namespace csrbf {
namespace {

constexpr int lanes = BallSums::lanes;
constexpr int terms = BallSums::terms;
constexpr int rows = 14;          // centre, 1 / sigma^2, quadric
constexpr double nowhere = 1e10;  // coordinates of the balls in empty slots: no support reaches that far

// Row k holds component k of all balls; rows are `stride` apart.
struct BallArrays {
  const double* data;
  Index stride;
};

CSRBF_ALWAYS_INLINE double at(const BallArrays& balls, int row, Index i) {
  return balls.data[row * balls.stride + i];
}

CSRBF_ALWAYS_INLINE void add_values(const BallArrays& balls, Index begin, Index end, const double* p, BallSums& sums) {
  for (Index first = begin; first < end; first += lanes)
    for (int l = 0; l < lanes; ++l) {
      const Index i = first + l;
      const double x = p[0] - at(balls, 0, i), y = p[1] - at(balls, 1, i), z = p[2] - at(balls, 2, i);
      const double r = std::sqrt((x * x + y * y + z * z) * at(balls, 3, i)), a = std::max(0.0, 1 - r), a2 = a * a;
      const double phi = a2 * a2 * (4 * r + 1);
      const double g = at(balls, 4, i) +
                       x * (at(balls, 5, i) + at(balls, 8, i) * x + 2 * (at(balls, 9, i) * y + at(balls, 10, i) * z)) +
                       y * (at(balls, 6, i) + at(balls, 11, i) * y + 2 * at(balls, 12, i) * z) +
                       z * (at(balls, 7, i) + at(balls, 13, i) * z);
      sums.W[0][l] += phi;
      sums.S[0][l] += phi * g;
    }
}

template <bool with_hessian>
CSRBF_ALWAYS_INLINE void add_derivatives(const BallArrays& balls, Index begin, Index end, const double* p,
                                         BallSums& sums) {
  for (Index first = begin; first < end; first += lanes)
    for (int l = 0; l < lanes; ++l) {
      const Index i = first + l;
      const double d[3] = {p[0] - at(balls, 0, i), p[1] - at(balls, 1, i), p[2] - at(balls, 2, i)};
      const double inverse2 = at(balls, 3, i);
      const double r = std::sqrt((d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * inverse2);
      const double a = std::max(0.0, 1 - r), a2 = a * a, phi = a2 * a2 * (4 * r + 1), slope = -20 * inverse2 * a2 * a;
      const double A[3][3] = {{at(balls, 8, i), at(balls, 9, i), at(balls, 10, i)},
                              {at(balls, 9, i), at(balls, 11, i), at(balls, 12, i)},
                              {at(balls, 10, i), at(balls, 12, i), at(balls, 13, i)}};
      double g = at(balls, 4, i), gradient[3];
      for (int c = 0; c < 3; ++c) {
        const double Ad = A[c][0] * d[0] + A[c][1] * d[1] + A[c][2] * d[2];
        g += d[c] * (at(balls, 5 + c, i) + Ad);
        gradient[c] = at(balls, 5 + c, i) + 2 * Ad;
      }
      sums.W[0][l] += phi;
      sums.S[0][l] += phi * g;
      for (int c = 0; c < 3; ++c) {
        sums.W[1 + c][l] += slope * d[c];
        sums.S[1 + c][l] += slope * d[c] * g + phi * gradient[c];
      }
      if constexpr (with_hessian) {
        // (phi'' - phi'/r) / r^2 has a pole at r = 0 that d d^T cancels.
        const double bend = 60 * inverse2 * inverse2 * a2 / std::max(r, 1e-100);
        for (int c = 0, term = 4; c < 3; ++c)
          for (int e = c; e < 3; ++e, ++term) {
            const double w = bend * d[c] * d[e] + (c == e ? slope : 0);
            sums.W[term][l] += w;
            sums.S[term][l] += w * g + slope * (d[c] * gradient[e] + d[e] * gradient[c]) + 2 * phi * A[c][e];
          }
      }
    }
}

}  // namespace

template <class Scalar>
Scalar total(const double (&sum)[terms][lanes], Derivatives derivatives) {
  std::array<double, terms> t{};
  for (std::size_t term = 0; term < terms; ++term)
    for (const double part : sum[term]) t[term] += part;
  if constexpr (std::is_same_v<Scalar, double>) {
    return t[0];
  } else {
    Scalar result(t[0]);
    result.gradient << t[1], t[2], t[3];
    if (derivatives < Derivatives::hessian) return result;
    result.hessian << t[4], t[5], t[6], t[5], t[7], t[8], t[6], t[8], t[9];
    return result;
  }
}

template double total<double>(const double (&)[terms][lanes], Derivatives);
template Taylor<3> total<Taylor<3>>(const double (&)[terms][lanes], Derivatives);

void store(const Taylor<3>& f, Index i, const JetBlock& out) {
  out.value[i] = f.value;
  if (out.gradient != nullptr) Eigen::Map<Point<3>>(out.gradient + 3 * i) = f.gradient;
  if (out.hessian == nullptr) return;
  for (int a = 0, entry = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b, ++entry) out.hessian[6 * i + entry] = f.hessian(a, b);
}

BallTree::BallTree(const PointsRef<3>& centers, const Eigen::VectorXd& supports, const Quadrics& quadrics)
    : tree_(centers, supports), slots_(tree_.slots(), rows) {
  for (Index i = 0; i < tree_.slots(); ++i) {
    const Index j = tree_.ball(i);
    slots_.row(i) << nowhere, nowhere, nowhere, 1, Eigen::RowVectorXd::Zero(rows - 4);
    if (j >= 0)
      slots_.row(i) << centers.col(j).transpose(), 1 / (supports[j] * supports[j]), quadrics.col(j).transpose();
  }
}

void BallTree::sum(const Point<3>& x, Derivatives derivatives, Runs& runs, BallSums& sums) const {
  std::fill_n(&sums.W[0][0], terms * lanes, 0.0);
  std::fill_n(&sums.S[0][0], terms * lanes, 0.0);
  tree_.find(x, runs);
  const BallArrays balls{slots_.data(), slots_.rows()};
  for (const auto& run : runs) {
    if (derivatives == Derivatives::none) simd<add_values>(balls, run.begin, run.end, x.data(), sums);
    if (derivatives == Derivatives::gradient) simd<add_derivatives<false>>(balls, run.begin, run.end, x.data(), sums);
    if (derivatives == Derivatives::hessian) simd<add_derivatives<true>>(balls, run.begin, run.end, x.data(), sums);
  }
}

}  // namespace csrbf
