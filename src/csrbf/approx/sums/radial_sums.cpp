#include "csrbf/approx/sums/radial_sums.hpp"

#include "csrbf/core/lanes.hpp"

namespace csrbf {
namespace {

constexpr Index width = 8;  // centres at a time

constexpr int triangle(int dimension) {
  return dimension * (dimension + 1) / 2;
}

// Place of entry (a, b) in an upper triangle stored by rows.
constexpr int entry(int dimension, int a, int b) {
  const int row = a < b ? a : b;
  const int column = a < b ? b : a;
  return row * dimension - row * (row - 1) / 2 + column - row;
}

template <class V>
CSRBF_ALWAYS_INLINE double total(const V& x) {
  return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}

// The arrays are copies here and below: the compiler need not ask whether the sums that are stored change them.
template <int Bytes, int Dim, bool Anisotropic>
CSRBF_ALWAYS_INLINE void distances(const CenterArrays c, const double* p, bool with_directions, RadialBatch& batch) {
  using V = Lanes<double, width, Bytes>;
  Index at = 0;
  for (int run = 0; run < batch.runs; ++run) {
    const Index end = batch.slot[run] + batch.length[run];
    for (Index i = batch.slot[run]; i < end; i += width, at += width) {
      V x[Dim];
#pragma GCC unroll 6
      for (int a = 0; a < Dim; ++a) x[a] = p[a] - V(c.position + a * c.stride + i);
      V sum(0.0);
#pragma GCC unroll 6
      for (int a = 0; a < Dim; ++a) {
        V v(0.0);
        if constexpr (Anisotropic) {
#pragma GCC unroll 6
          for (int b = 0; b < Dim; ++b) v += V(c.shape + entry(Dim, a, b) * c.stride + i) * x[b];
        } else {
          v = V(c.shape + i) * x[a];
        }
        sum += v * x[a];
        if (with_directions) v.store(&batch.v[a][at]);
      }
      sum.store(batch.r2 + at);
    }
  }
}

enum class Sums { value, gradient, hessian };

template <int Bytes, int Dim, bool Anisotropic, Sums sums>
CSRBF_ALWAYS_INLINE void add(const CenterArrays c, const double* coefficients, const RadialBatch& batch, double* value,
                             double* gradient, double* hessian) {
  using V = Lanes<double, width, Bytes>;
  V sum(0.0);
  V first[Dim]{};
  V second[triangle(Dim)]{};
  Index at = 0;
  for (int run = 0; run < batch.runs; ++run) {
    const Index end = batch.slot[run] + batch.length[run];
    for (Index i = batch.slot[run]; i < end; i += width, at += width) {
      const V alpha(coefficients + i);
      sum += alpha * V(batch.phi + at);
      if constexpr (sums != Sums::value) {
        const V g = alpha * V(batch.g + at);
#pragma GCC unroll 6
        for (int a = 0; a < Dim; ++a) first[a] += g * V(&batch.v[a][at]);
        if constexpr (sums == Sums::hessian) {
          const V h = alpha * V(batch.h + at);
#pragma GCC unroll 6
          for (int a = 0; a < Dim; ++a) {
#pragma GCC unroll 6
            for (int b = a; b < Dim; ++b) {
              V& target = second[entry(Dim, a, b)];
              target += h * V(&batch.v[a][at]) * V(&batch.v[b][at]);
              if constexpr (Anisotropic) {
                target += g * V(c.shape + entry(Dim, a, b) * c.stride + i);
              } else {
                if (a == b) target += g * V(c.shape + i);
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
struct Distances {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(const CenterArrays* c, const double* p, bool with_directions,
                                      RadialBatch* batch) {
    if (c->anisotropic)
      distances<Bytes, Dim, true>(*c, p, with_directions, *batch);
    else
      distances<Bytes, Dim, false>(*c, p, with_directions, *batch);
  }
};

template <int Dim, Sums sums>
struct Add {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(const CenterArrays* c, const double* coefficients, const RadialBatch* batch,
                                      double* value, double* gradient, double* hessian) {
    if (c->anisotropic)
      add<Bytes, Dim, true, sums>(*c, coefficients, *batch, value, gradient, hessian);
    else
      add<Bytes, Dim, false, sums>(*c, coefficients, *batch, value, gradient, hessian);
  }
};

// Place of a dimension among those of CSRBF_FOR_MANY_DIMS.
constexpr int place_of(int dimension) {
  return dimension <= largest_dimension ? dimension - 1 : largest_dimension;
}

using DistanceLoop = void (*)(const CenterArrays*, const double*, bool, RadialBatch*);
using SumLoop = void (*)(const CenterArrays*, const double*, const RadialBatch*, double*, double*, double*);

}  // namespace

void radial_distances(const CenterArrays& centers, const double* p, bool with_directions, RadialBatch& batch) {
#define CSRBF_ENTRY(Dim) simd_call<Distances<Dim>>,
  static constexpr DistanceLoop loops[] = {CSRBF_FOR_MANY_DIMS(CSRBF_ENTRY)};
#undef CSRBF_ENTRY
  loops[place_of(centers.dimension)](&centers, p, with_directions, &batch);
}

void add_radial_sums(const CenterArrays& centers, const double* coefficients, const RadialBatch& batch, double* value,
                     double* gradient, double* hessian) {
#define CSRBF_ENTRY(Dim) \
  {simd_call<Add<Dim, Sums::value>>, simd_call<Add<Dim, Sums::gradient>>, simd_call<Add<Dim, Sums::hessian>>},
  static constexpr SumLoop loops[][3] = {CSRBF_FOR_MANY_DIMS(CSRBF_ENTRY)};
#undef CSRBF_ENTRY
  const int derivatives = hessian != nullptr ? 2 : gradient != nullptr ? 1 : 0;
  loops[place_of(centers.dimension)][derivatives](&centers, coefficients, &batch, value, gradient, hessian);
}

}  // namespace csrbf
