#include "csrbf/surface/composite/patch_rows.hpp"

#include "csrbf/linalg/gram.hpp"
#include "csrbf/surface/composite/patch_kernel.hpp"

namespace csrbf {

namespace {

CSRBF_ALWAYS_INLINE void quadric_columns_loop(const double* q, Index K, const double* root_w, const double* root_g,
                                              double* columns) {
  const double* x = q;
  const double* y = q + K;
  const double* z = q + 2 * K;
  const Index stride = 4 * K;
  for (Index k = 0; k < K; ++k) {
    const double w = root_w[k], wx = w * x[k], wy = w * y[k], wz = w * z[k];
    double* c = columns + k;
    c[0] = w;
    c[stride] = wx;
    c[2 * stride] = wy;
    c[3 * stride] = wz;
    c[4 * stride] = wx * x[k];
    c[5 * stride] = wx * y[k];
    c[6 * stride] = wx * z[k];
    c[7 * stride] = wy * y[k];
    c[8 * stride] = wy * z[k];
    c[9 * stride] = wz * z[k];
  }
  for (Index k = 0; k < K; ++k) {
    const double g = root_g[k], gx = g * x[k], gy = g * y[k], gz = g * z[k];
    double* dx = columns + K + k;
    double* dy = dx + K;
    double* dz = dy + K;
    dx[0] = dy[0] = dz[0] = 0;
    dx[stride] = dy[2 * stride] = dz[3 * stride] = g;
    dy[stride] = dz[stride] = dx[2 * stride] = dz[2 * stride] = dx[3 * stride] = dy[3 * stride] = 0;
    dx[4 * stride] = 2 * gx;
    dy[4 * stride] = dz[4 * stride] = 0;
    dx[5 * stride] = gy;
    dy[5 * stride] = gx;
    dz[5 * stride] = 0;
    dx[6 * stride] = gz;
    dy[6 * stride] = 0;
    dz[6 * stride] = gx;
    dy[7 * stride] = 2 * gy;
    dx[7 * stride] = dz[7 * stride] = 0;
    dx[8 * stride] = 0;
    dy[8 * stride] = gz;
    dz[8 * stride] = gy;
    dz[9 * stride] = 2 * gz;
    dx[9 * stride] = dy[9 * stride] = 0;
  }
}

// Eight points at a time, whose sums stay in registers.
struct PieceJets {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(const double* q, Index K, const double* b, const double* centers,
                                      const double* alpha, Index M, double* jets) {
    using Numbers = Lanes<double, 8, Bytes>;
    constexpr Index size = Numbers::size;
    for (Index k = 0; k < K; k += size) {
      const Index count = std::min(size, K - k);
      double point[3][size], jet[4][size];
      for (Index c = 0; c < 3; ++c)
        for (Index l = 0; l < size; ++l) point[c][l] = q[c * K + k + std::min(l, count - 1)];
      const Numbers x(point[0]), y(point[1]), z(point[2]);
      const Numbers px = b[4] * x + b[1], py = b[7] * y + b[2], pz = b[9] * z + b[3];
      Numbers f = x * (px + (b[5] * y + b[6] * z)) + b[0];
      f += y * (b[8] * z + py);
      f += z * pz;
      Numbers fx = b[6] * z + (b[5] * y + (b[4] * x + px));
      Numbers fy = b[8] * z + (b[5] * x + (b[7] * y + py));
      Numbers fz = b[8] * y + (b[6] * x + (b[9] * z + pz));
      for (Index j = 0; j < M; ++j) {
        const Numbers dx = x - centers[3 * j], dy = y - centers[3 * j + 1], dz = z - centers[3 * j + 2];
        const Numbers dx2 = dx * dx, dxy2 = dy * dy + dx2, d2 = dz * dz + dxy2;
        const patch_kernel::ValueAndSlope<Numbers> phi(d2);
        const Numbers slope = alpha[j] * phi.slope;
        f += alpha[j] * phi.value;
        fx += slope * dx;
        fy += slope * dy;
        fz += slope * dz;
      }
      f.store(jet[0]);
      fx.store(jet[1]);
      fy.store(jet[2]);
      fz.store(jet[3]);
      for (Index c = 0; c < 4; ++c) std::copy_n(jet[c], count, jets + c * K + k);
    }
  }
};

// Four samples at a time: their number is a multiple of it.
struct KernelColumns {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(const double* q, Index K, const double* root_w, const double* root_g,
                                      const double* centers, Index M, double* columns) {
    using Numbers = Lanes<double, gram_rows, Bytes>;
    for (Index j = 0; j < M; ++j) {
      const double cx = centers[3 * j], cy = centers[3 * j + 1], cz = centers[3 * j + 2];
      double* value = columns + 4 * K * j;
      for (Index k = 0; k < K; k += Numbers::size, value += Numbers::size) {
        const Numbers dx = Numbers(q + k) - cx, dy = Numbers(q + K + k) - cy, dz = Numbers(q + 2 * K + k) - cz;
        const Numbers dx2 = dx * dx, dxy2 = dy * dy + dx2, d2 = dz * dz + dxy2;
        const patch_kernel::ValueAndSlope<Numbers> phi(d2);
        const Numbers slope = Numbers(root_g + k) * phi.slope;
        (Numbers(root_w + k) * phi.value).store(value);
        (slope * dx).store(value + K);
        (slope * dy).store(value + 2 * K);
        (slope * dz).store(value + 3 * K);
      }
    }
  }
};

// Entries above the diagonal may change, too.
struct KernelMatrix {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(const double* centers, Index M, double factor, double* A, Index stride) {
    using Numbers = Lanes<double, 4, Bytes>;
    const double *x = centers, *y = centers + M, *z = centers + 2 * M;
    for (Index j = 0; j < M; ++j) {
      double* column = A + j * stride;
      Index i = std::max<Index>(0, M - (M - j + Numbers::size - 1) / Numbers::size * Numbers::size);
      for (; i + Numbers::size <= M; i += Numbers::size) {
        const Numbers dx = Numbers(x + i) - x[j], dy = Numbers(y + i) - y[j], dz = Numbers(z + i) - z[j];
        const Numbers dx2 = dx * dx, dxy2 = dy * dy + dx2, d2 = dz * dz + dxy2;
        const patch_kernel::ValueAndSlope<Numbers> phi(d2);
        (Numbers(column + i) + factor * phi.value).store(column + i);
      }
      for (; i < M; ++i) {
        const double dx = x[i] - x[j], dy = y[i] - y[j], dz = z[i] - z[j];
        column[i] += factor * patch_kernel::value(dx * dx + dy * dy + dz * dz);
      }
    }
  }
};

}  // namespace

void quadric_columns(const double* q, Index K, const double* root_w, const double* root_g, double* columns) {
  simd<quadric_columns_loop>(q, K, root_w, root_g, columns);
}

void kernel_columns(const double* q, Index K, const double* root_w, const double* root_g, const double* centers,
                    Index M, double* columns) {
  simd_call<KernelColumns, 32>(q, K, root_w, root_g, centers, M, columns);
}

void piece_jets(const double* q, Index K, const double* b, const double* centers, const double* alpha, Index M,
                double* jets) {
  simd_call<PieceJets>(q, K, b, centers, alpha, M, jets);
}

void add_kernel_matrix(const double* centers, Index M, double factor, double* A, Index stride) {
  simd_call<KernelMatrix, 32>(centers, M, factor, A, stride);
}

}  // namespace csrbf
