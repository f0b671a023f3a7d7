#include "csrbf/approx/basis/radial_sums.hpp"

#include "csrbf/core/simd.hpp"

namespace csrbf {
namespace {

constexpr Index width = 8;
using Lanes = double __attribute__((vector_size(width * sizeof(double)), aligned(8)));

constexpr int triangle(int dimension) {
  return dimension * (dimension + 1) / 2;
}

// Place of entry (a, b) in an upper triangle stored by rows.
constexpr int entry(int dimension, int a, int b) {
  const int row = a < b ? a : b;
  const int column = a < b ? b : a;
  return row * dimension - row * (row - 1) / 2 + column - row;
}

CSRBF_ALWAYS_INLINE const Lanes& lanes(const double* data) {
  return *reinterpret_cast<const Lanes*>(data);
}
CSRBF_ALWAYS_INLINE Lanes& lanes(double* data) {
  return *reinterpret_cast<Lanes*>(data);
}

CSRBF_ALWAYS_INLINE double total(const Lanes& x) {
  return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}

template <int Dim, bool Anisotropic>
CSRBF_ALWAYS_INLINE void distances(const CenterArrays& c, const double* p, bool with_directions, RadialBatch& batch) {
  Index at = 0;
  for (int run = 0; run < batch.runs; ++run) {
    const Index end = batch.slot[static_cast<std::size_t>(run)] + batch.length[static_cast<std::size_t>(run)];
    for (Index i = batch.slot[static_cast<std::size_t>(run)]; i < end; i += width, at += width) {
      Lanes x[Dim];
      for (int a = 0; a < Dim; ++a) x[a] = p[a] - lanes(c.position + a * c.stride + i);
      Lanes sum{};
      for (int a = 0; a < Dim; ++a) {
        Lanes v{};
        if constexpr (Anisotropic) {
          for (int b = 0; b < Dim; ++b) v += lanes(c.shape + entry(Dim, a, b) * c.stride + i) * x[b];
        } else {
          v = lanes(c.shape + i) * x[a];
        }
        sum += v * x[a];
        if (with_directions) lanes(&batch.v[a][at]) = v;
      }
      lanes(batch.r2 + at) = sum;
    }
  }
}

enum class Sums { value, gradient, hessian };

template <int Dim, bool Anisotropic, Sums sums>
CSRBF_ALWAYS_INLINE void add(const CenterArrays& c, const double* coefficients, const RadialBatch& batch, double* value,
                             double* gradient, double* hessian) {
  Lanes sum{};
  Lanes first[Dim]{};
  Lanes second[triangle(Dim)]{};
  Index at = 0;
  for (int run = 0; run < batch.runs; ++run) {
    const Index end = batch.slot[static_cast<std::size_t>(run)] + batch.length[static_cast<std::size_t>(run)];
    for (Index i = batch.slot[static_cast<std::size_t>(run)]; i < end; i += width, at += width) {
      const Lanes alpha = lanes(coefficients + i);
      sum += alpha * lanes(batch.phi + at);
      if constexpr (sums != Sums::value) {
        const Lanes g = alpha * lanes(batch.g + at);
        for (int a = 0; a < Dim; ++a) first[a] += g * lanes(&batch.v[a][at]);
        if constexpr (sums == Sums::hessian) {
          const Lanes h = alpha * lanes(batch.h + at);
          for (int a = 0; a < Dim; ++a) {
            for (int b = a; b < Dim; ++b) {
              Lanes& target = second[entry(Dim, a, b)];
              target += h * lanes(&batch.v[a][at]) * lanes(&batch.v[b][at]);
              if constexpr (Anisotropic) {
                target += g * lanes(c.shape + entry(Dim, a, b) * c.stride + i);
              } else {
                if (a == b) target += g * lanes(c.shape + i);
              }
            }
          }
        }
      }
    }
  }
  *value += total(sum);
  if constexpr (sums != Sums::value)
    for (int a = 0; a < Dim; ++a) gradient[a] += total(first[a]);
  if constexpr (sums == Sums::hessian)
    for (int e = 0; e < triangle(Dim); ++e) hessian[e] += total(second[e]);
}

template <int Dim>
CSRBF_ALWAYS_INLINE void distances_in(const CenterArrays& c, const double* p, bool with_directions,
                                      RadialBatch& batch) {
  if (c.anisotropic)
    distances<Dim, true>(c, p, with_directions, batch);
  else
    distances<Dim, false>(c, p, with_directions, batch);
}

template <int Dim, Sums sums>
CSRBF_ALWAYS_INLINE void add_in(const CenterArrays& c, const double* coefficients, const RadialBatch& batch,
                                double* value, double* gradient, double* hessian) {
  if (c.anisotropic)
    add<Dim, true, sums>(c, coefficients, batch, value, gradient, hessian);
  else
    add<Dim, false, sums>(c, coefficients, batch, value, gradient, hessian);
}

#define CSRBF_RADIAL_LOOPS(Dim)                                                                                        \
  CSRBF_SIMD_CLONES void distances_##Dim(const CenterArrays& c, const double* p, bool v, RadialBatch& batch) {         \
    distances_in<Dim>(c, p, v, batch);                                                                                 \
  }                                                                                                                    \
  CSRBF_SIMD_CLONES void values_##Dim(const CenterArrays& c, const double* alpha, const RadialBatch& batch, double* f, \
                                      double* df, double* ddf) {                                                       \
    add_in<Dim, Sums::value>(c, alpha, batch, f, df, ddf);                                                             \
  }                                                                                                                    \
  CSRBF_SIMD_CLONES void gradients_##Dim(const CenterArrays& c, const double* alpha, const RadialBatch& batch,         \
                                         double* f, double* df, double* ddf) {                                         \
    add_in<Dim, Sums::gradient>(c, alpha, batch, f, df, ddf);                                                          \
  }                                                                                                                    \
  CSRBF_SIMD_CLONES void hessians_##Dim(const CenterArrays& c, const double* alpha, const RadialBatch& batch,          \
                                        double* f, double* df, double* ddf) {                                          \
    add_in<Dim, Sums::hessian>(c, alpha, batch, f, df, ddf);                                                           \
  }
CSRBF_FOR_EACH_DIM(CSRBF_RADIAL_LOOPS)
#undef CSRBF_RADIAL_LOOPS

using DistanceLoop = void (*)(const CenterArrays&, const double*, bool, RadialBatch&);
using SumLoop = void (*)(const CenterArrays&, const double*, const RadialBatch&, double*, double*, double*);

}  // namespace

void radial_distances(const CenterArrays& centers, const double* p, bool with_directions, RadialBatch& batch) {
#define CSRBF_ENTRY(Dim) distances_##Dim,
  static constexpr DistanceLoop loops[] = {CSRBF_FOR_EACH_DIM(CSRBF_ENTRY)};
#undef CSRBF_ENTRY
  loops[centers.dimension - 1](centers, p, with_directions, batch);
}

void add_radial_sums(const CenterArrays& centers, const double* coefficients, const RadialBatch& batch, double* value,
                     double* gradient, double* hessian) {
#define CSRBF_ENTRY(Dim) {values_##Dim, gradients_##Dim, hessians_##Dim},
  static constexpr SumLoop loops[][3] = {CSRBF_FOR_EACH_DIM(CSRBF_ENTRY)};
#undef CSRBF_ENTRY
  const int derivatives = hessian != nullptr ? 2 : gradient != nullptr ? 1 : 0;
  loops[centers.dimension - 1][derivatives](centers, coefficients, batch, value, gradient, hessian);
}

}  // namespace csrbf
