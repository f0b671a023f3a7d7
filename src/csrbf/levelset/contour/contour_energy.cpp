#include "csrbf/levelset/contour/contour_energy.hpp"

#include "csrbf/core/lanes.hpp"
#include "csrbf/levelset/contour/spectral_descent.hpp"
#include "csrbf/levelset/lattice/coefficient_sums.hpp"

#include <limits>

namespace csrbf {
namespace {

constexpr Index block_size = 256;  // voxels gathered at a time: a few kB, which stay in the first cache

struct Profile {
  float inverse_eps, anchor, length, volume;
};

constexpr Index width = 16;  // voxels at a time
template <int Bytes>
using Voxels = Lanes<float, width, Bytes>;

constexpr Index padded(Index n) {
  return (n + width - 1) / width * width;
}

template <class V>
CSRBF_ALWAYS_INLINE V clamped_to_one(const V& x) {
  const V above = choose(x < -1.0F, V(-1.0F), x);
  return choose(above > 1.0F, V(1.0F), above);
}
template <class V>
CSRBF_ALWAYS_INLINE float sum_of_lanes(const V& x) {
  float sum = 0;
  for (int i = 0; i < V::size; ++i) sum += x[i];
  return sum;
}

float target_of(float force) {
  return std::min(1.0F, std::max(-1.0F, -0.5F * force));
}

// H_eps, its derivative, and what f is off its target, at 16 voxels.
template <class V>
struct Step {
  V t, bump, H, delta, off;
  CSRBF_ALWAYS_INLINE Step(const Profile& by, const V& force, const V& f) {
    t = clamped_to_one(f * by.inverse_eps);
    const V t2 = t * t;
    bump = 1.0F - t2;
    H = 0.5F + t * (0.9375F - t2 * (0.625F - t2 * 0.1875F));
    delta = (0.9375F * by.inverse_eps) * bump * bump;
    off = f - clamped_to_one(-0.5F * force);
  }
};

// Terms of E without the length, their derivatives in place of f. n is a multiple of `width`.
struct RegionTerms {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static float run(const Profile* profile, const float* force, Index n, float* f) {
    using V = Voxels<Bytes>;
    const Profile by = *profile;
    V sum(0.0F);
    for (Index i = 0; i < n; i += width) {
      const V F(force + i);
      const Step<V> at(by, F, V(f + i));
      const V region = F * at.H, anchor = (0.5F * by.anchor) * at.off * at.off;
      sum += region + anchor;
      const V region_slope = F * at.delta, anchor_slope = by.anchor * at.off;
      (by.volume * (region_slope + anchor_slope)).store(f + i);
    }
    return by.volume * sum_of_lanes(sum);
  }
};

// As above and with the length; fz is that of three dimensions, else it is not used.
template <int Dim>
struct LengthTerms {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static float run(const Profile* profile, const float* force, const float* weights, Index n,
                                       float* f, float* fx, float* fy, float* fz) {
    using V = Voxels<Bytes>;
    const Profile by = *profile;
    V sum(0.0F);
    for (Index i = 0; i < n; i += width) {
      const V F(force + i), x(fx + i), y(fy + i), length = V(weights + i) * by.length;
      V z(0.0F);
      if constexpr (Dim == 3) z = V(fz + i);
      const Step<V> at(by, F, V(f + i));
      const V norm = sqrt(1e-20F + x * x + y * y + z * z);
      const V region = F * at.H, anchor = (0.5F * by.anchor) * at.off * at.off;
      sum += region + anchor + length * at.delta * norm;
      const V slope = (-3.75F * by.inverse_eps * by.inverse_eps) * at.t * at.bump;
      const V region_slope = F * at.delta, anchor_slope = by.anchor * at.off;
      (by.volume * (region_slope + anchor_slope + length * slope * norm)).store(f + i);
      const V along = by.volume * length * at.delta / norm;
      (x * along).store(fx + i);
      (y * along).store(fy + i);
      if constexpr (Dim == 3) (z * along).store(fz + i);
    }
    return by.volume * sum_of_lanes(sum);
  }
};

// Squared hinge loss, halved: by how much values miss the margin on the side of their force; derivatives in place of f.
struct Shortfalls {
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static float run(float margin, const float* force, Index n, float* f) {
    using V = Voxels<Bytes>;
    V sum(0.0F);
    for (Index i = 0; i < n; i += width) {
      const V F(force + i);
      const V wanted = choose(F < 0.0F, -0.5F * F, 0.5F * F);
      const V side = choose(F < 0.0F, V(1.0F), V(-1.0F));
      const V gap = choose(wanted < margin, wanted, V(margin)) - side * V(f + i);
      const V none(0.0F);
      const V missing = choose(F != 0.0F, choose(gap > 0.0F, gap, none), none);  // 0: outside the mask
      sum += 0.5F * missing * missing;
      (-side * missing).store(f + i);
    }
    return sum_of_lanes(sum);
  }
};

using Block = std::array<float, block_size>;

// n values of a row, one after the other, and zeros up to a multiple of `width`.
void gather(const float* values, const LatticeRow& row, Index begin, Index n, Block& place) {
  const float* from = values + row.voxel + begin * row.stride;
  for (Index i = 0; i < n; ++i) place[i] = from[i * row.stride];
  std::fill(place.begin() + n, place.begin() + padded(n), 0.0F);
}

template <int Dim>
double row_energy(const Profile& profile, bool gradients, const ContourEnergy& energy, const LatticeRow& row) {
  double sum = 0;
  Block force, weight, f;
  std::array<Block, Dim> slope;
  weight.fill(1);
  for (Index begin = 0; begin < row.count; begin += block_size) {
    const Index n = std::min(block_size, row.count - begin);
    gather(energy.force, row, begin, n, force);
    // Values 0 with force 0 add force H = 0 and no length, whose gradient is 0 there.
    std::copy_n(row.value + begin, n, f.begin());
    std::fill(f.begin() + n, f.begin() + padded(n), 0.0F);
    if (!gradients) {
      sum += static_cast<double>(simd_call<RegionTerms>(&profile, force.data(), padded(n), f.data()));
    } else {
      if (energy.weights != nullptr) gather(energy.weights, row, begin, n, weight);
      for (std::size_t a = 0; a < Dim; ++a) {
        std::copy_n(row.gradient[a] + begin, n, slope[a].begin());
        std::fill(slope[a].begin() + n, slope[a].begin() + padded(n), 0.0F);
      }
      sum += static_cast<double>(simd_call<LengthTerms<Dim>>(&profile, force.data(), weight.data(), padded(n), f.data(),
                                                             slope[0].data(), slope[1].data(), slope[Dim - 1].data()));
      for (std::size_t a = 0; a < Dim; ++a) std::copy_n(slope[a].begin(), n, row.gradient[a] + begin);
    }
    std::copy_n(f.begin(), n, row.value + begin);
  }
  return sum;
}

// Volume of a voxel in units of its shortest edge.
template <int Dim>
double voxel_volume(const Lattice<Dim>& lattice) {
  const Point<Dim> edges = lattice.spacing().template head<Dim>();
  return edges.prod() / std::pow(edges.minCoeff(), Dim);
}

// The ridge of the least-squares part: a small share of what a coefficient weighs by its voxels. It bounds what the
// voxels leave undetermined, and with it the number of steps to the solution.
template <int Dim>
double ridge(const Lattice<Dim>& lattice) {
  constexpr double share = 0.01;  // by hand: larger biases f towards 0, smaller takes more steps
  return share * voxel_volume(lattice) * lattice.coefficient_weight();
}

constexpr float largest_coefficient = 2;  // by hand: room above the targets, which are at most 1

// With a length |f| must not become so steep that the contour falls between voxels.
float coefficient_bound(const ContourEnergy& energy) {
  return energy.length > 0 ? 1 : largest_coefficient;
}

}  // namespace

template <int Dim>
double contour_energy(const Lattice<Dim>& lattice, const ContourEnergy& energy, const float* coefficients,
                      float* derivatives) {
  const double unit = lattice.spacing().template head<Dim>().minCoeff();
  const Profile profile{static_cast<float>(1 / energy.eps), static_cast<float>(energy.anchor),
                        static_cast<float>(energy.length * unit), static_cast<float>(voxel_volume(lattice))};
  const bool gradients = energy.length > 0;
  const double sum = lattice.sweep(
      coefficients, gradients, [&](const LatticeRow& row) { return row_energy<Dim>(profile, gradients, energy, row); },
      derivatives);
  const double weight = energy.anchor * ridge(lattice);
  const auto n = static_cast<std::size_t>(lattice.coefficients());
  if (derivatives != nullptr)
    for_all(n, [&](std::size_t i) { derivatives[i] += static_cast<float>(weight) * coefficients[i]; });
  return sum + 0.5 * weight * sum_of(n, [&](std::size_t i) {
                 return static_cast<double>(coefficients[i]) * static_cast<double>(coefficients[i]);
               });
}

template <int Dim>
void fit_target(const Lattice<Dim>& lattice, const ContourEnergy& energy, int iterations,
                std::vector<float>& coefficients) {
  constexpr double accuracy = 1e-3;  // relative residual; by hand: errors far below those of the energy
  const double volume = voxel_volume(lattice), weight = ridge(lattice);
  const auto n = static_cast<std::size_t>(lattice.array_size());
  // B^T V (target - B a) - ridge a, or without the target
  const auto residual = [&](const std::vector<float>& a, bool with_target, std::vector<float>& r) {
    lattice.sweep(
        a.data(), false,
        [&](const LatticeRow& row) {
          const float* force = energy.force + row.voxel;
          for (Index i = 0; i < row.count; ++i)
            row.value[i] =
                static_cast<float>(volume) * ((with_target ? target_of(force[i * row.stride]) : 0.0F) - row.value[i]);
          return 0.0;
        },
        r.data());
    for_all(n, [&](std::size_t i) { r[i] -= static_cast<float>(weight) * a[i]; });
  };
  std::vector<float> r(n), p, Ap(n);
  residual(coefficients, true, r);
  p = r;
  double rr = dot(r, r);
  const double enough = accuracy * accuracy * rr;
  for (int i = 0; i < iterations && rr > enough; ++i) {
    residual(p, false, Ap);
    const auto a = static_cast<float>(-rr / dot(p, Ap));
    for_all(n, [&](std::size_t j) {
      coefficients[j] += a * p[j];
      r[j] += a * Ap[j];
    });
    const double next = dot(r, r);
    const auto b = static_cast<float>(next / rr);
    for_all(n, [&](std::size_t j) { p[j] = r[j] + b * p[j]; });
    rr = next;
  }
}

template <int Dim>
int minimize_contour_energy(const Lattice<Dim>& lattice, const ContourEnergy& energy, int iterations, double tolerance,
                            std::vector<float>& coefficients, std::vector<double>& energies) {
  // About the inverse curvature of the anchor.
  const double rate = 1 / (std::max(energy.anchor, 1e-3) * voxel_volume(lattice) * lattice.coefficient_weight());
  return spectral_descent(
      [&](const float* x, float* derivatives) { return contour_energy(lattice, energy, x, derivatives); },
      {coefficient_bound(energy), rate, iterations, tolerance}, coefficients, energies);
}

template <int Dim>
int separate_voxels(const Lattice<Dim>& lattice, const float* force, double margin, int iterations,
                    std::vector<float>& coefficients) {
  constexpr double tolerance = 3e-3;  // share of the decrease so far; by hand: larger ends earlier
  std::vector<double> sums;
  const auto row_sum = [&](const LatticeRow& row) {
    double sum = 0;
    Block forces, f;
    for (Index begin = 0; begin < row.count; begin += block_size) {
      const Index n = std::min(block_size, row.count - begin);
      gather(force, row, begin, n, forces);
      std::copy_n(row.value + begin, n, f.begin());
      std::fill(f.begin() + n, f.begin() + padded(n), 0.0F);
      sum += static_cast<double>(
          simd_call<Shortfalls, 32>(static_cast<float>(margin), forces.data(), padded(n), f.data()));
      std::copy_n(f.begin(), n, row.value + begin);
    }
    return sum;
  };
  return spectral_descent(
      [&](const float* x, float* derivatives) { return lattice.sweep(x, false, row_sum, derivatives); },
      {largest_coefficient, 1 / lattice.coefficient_weight(), iterations, tolerance}, coefficients, sums);
}

template <int Dim>
double target_residual(const Lattice<Dim>& lattice, const ContourEnergy& energy, const std::vector<float>& coefficients,
                       double least) {
  // A sweep gives one sum: the number of voxels takes another, a fraction of a fit.
  const auto sum = [&](bool squares) {
    return lattice.sweep(
        coefficients.data(), false,
        [&](const LatticeRow& row) {
          double part = 0;
          for (Index i = 0; i < row.count; ++i) {
            const float f = row.value[i];
            if (std::abs(f) < static_cast<float>(least)) continue;
            const auto off = static_cast<double>(f - target_of(energy.force[row.voxel + i * row.stride]));
            part += squares ? off * off : 1;
          }
          return part;
        },
        nullptr);
  };
  const double voxels = sum(false);
  return voxels > 0 ? std::sqrt(sum(true) / voxels) : 0;
}

template <int Dim>
Index update_labels(const Lattice<Dim>& lattice, const std::vector<float>& coefficients, unsigned char* labels) {
  return static_cast<Index>(lattice.sweep(
      coefficients.data(), false,
      [&](const LatticeRow& row) {
        Index changed = 0;
        unsigned char* label = labels + row.voxel;
        for (Index i = 0; i < row.count; ++i, label += row.stride) {
          const unsigned char now = row.value[i] > 0 ? 1 : 0;
          changed += now != *label ? 1 : 0;
          *label = now;
        }
        return static_cast<double>(changed);
      },
      nullptr));
}

template <int Dim>
void update_labels(const Lattice<Dim>& lattice, const std::vector<const float*>& coefficients,
                   std::vector<std::uint8_t>& labels) {
  std::vector<float> best(labels.size(), -std::numeric_limits<float>::infinity());
  for (std::size_t k = 0; k < coefficients.size(); ++k)
    lattice.sweep(
        coefficients[k], false,
        [&](const LatticeRow& row) {
          for (Index i = 0; i < row.count; ++i) {
            const auto voxel = static_cast<std::size_t>(row.voxel + i * row.stride);
            if (row.value[i] <= best[voxel]) continue;
            best[voxel] = row.value[i];
            labels[voxel] = static_cast<std::uint8_t>(k);
          }
          return 0.0;
        },
        nullptr);
}

#define CSRBF_INSTANTIATE(Dim)                                                                                        \
  template double contour_energy<Dim>(const Lattice<Dim>&, const ContourEnergy&, const float*, float*);               \
  template void fit_target<Dim>(const Lattice<Dim>&, const ContourEnergy&, int, std::vector<float>&);                 \
  template int minimize_contour_energy<Dim>(const Lattice<Dim>&, const ContourEnergy&, int, double,                   \
                                            std::vector<float>&, std::vector<double>&);                               \
  template int separate_voxels<Dim>(const Lattice<Dim>&, const float*, double, int, std::vector<float>&);             \
  template double target_residual<Dim>(const Lattice<Dim>&, const ContourEnergy&, const std::vector<float>&, double); \
  template Index update_labels<Dim>(const Lattice<Dim>&, const std::vector<float>&, unsigned char*);                  \
  template void update_labels<Dim>(const Lattice<Dim>&, const std::vector<const float*>&, std::vector<std::uint8_t>&);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
