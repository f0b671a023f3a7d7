#pragma once

#include "csrbf/core/simd.hpp"
#include "csrbf/core/types.hpp"

#include <algorithm>
#include <memory>

namespace csrbf {

/// Where the parts of a radial function at n points are written; g and h are null when not requested, h whenever g is.
struct RadialOutput {
  double* phi = nullptr;
  double* g = nullptr;
  double* h = nullptr;
};

/// The formulas behind a Kernel.
class RadialFunction {
 public:
  RadialFunction() = default;
  RadialFunction(const RadialFunction&) = default;
  RadialFunction& operator=(const RadialFunction&) = default;
  virtual ~RadialFunction() = default;

  /// The parts at n squared distances, conventions as in Kernel.
  virtual void evaluate(const double* r2, Index n, const RadialOutput& out) const = 0;
};

/// phi, phi'/r and (phi'' - phi'/r)/r^2 at one point.
struct Radial {
  double phi;
  double g;
  double h;
};

/// Squared distances below this count as 0: their squares would underflow.
inline constexpr double center_r2 = 1e-200;

enum class RadialParts { value, gradient, hessian };

/// Number of squared distances in a block of radial_loop(): one register of AVX-512, two of AVX2.
inline constexpr Index radial_block = 8;

/// Writes the parts of `f`, a function object r2 -> Radial whose unused parts the compiler removes. n is a multiple of
/// radial_block; written so that the compiler knows and emits vector code without a remainder loop.
template <RadialParts parts, class Function>
CSRBF_ALWAYS_INLINE void radial_loop(const Function f, const double* __restrict r2, Index n, double* __restrict phi,
                                     double* __restrict g, double* __restrict h) {
  const Index end = n & -radial_block;
  for (Index i = 0; i < end; ++i) {
    const Radial at = f(r2[i]);
    phi[i] = at.phi;
    if constexpr (parts >= RadialParts::gradient) g[i] = at.g;
    if constexpr (parts >= RadialParts::hessian) h[i] = at.h;
  }
}

/// radial_loop() into the arrays of `out`.
template <RadialParts parts, class Formula>
CSRBF_ALWAYS_INLINE void formula_loop(const Formula& formula, const double* r2, Index n, const RadialOutput& out) {
  radial_loop<parts>(formula, r2, n, out.phi, out.g, out.h);
}

/// Runs `loop(r2, n, out)`, which handles full blocks only, for any n.
template <class Loop>
void in_radial_blocks(const Loop& loop, const double* r2, Index n, const RadialOutput& out) {
  const auto run = [&](Index i, Index count) {
    loop(r2 + i, count,
         RadialOutput{out.phi + i, out.g == nullptr ? nullptr : out.g + i, out.h == nullptr ? nullptr : out.h + i});
  };
  if (n >= radial_block) {
    run(0, n & -radial_block);
    if (n % radial_block != 0) run(n - radial_block, radial_block);  // the last block overlaps the one before
    return;
  }
  double few[radial_block] = {};
  double parts[3][radial_block];
  std::copy(r2, r2 + n, few);
  loop(few, radial_block, RadialOutput{parts[0], parts[1], parts[2]});
  std::copy(parts[0], parts[0] + n, out.phi);
  if (out.g != nullptr) std::copy(parts[1], parts[1] + n, out.g);
  if (out.h != nullptr) std::copy(parts[2], parts[2] + n, out.h);
}

/// The function of a formula, an object that radial_loop() takes.
template <class Formula>
class FormulaFunction : public RadialFunction {
 public:
  explicit FormulaFunction(const Formula& formula) : formula_(formula) {}

  void evaluate(const double* r2, Index n, const RadialOutput& out) const override {
    using enum RadialParts;
    const auto loop = out.g == nullptr   ? simd<formula_loop<value, Formula>>
                      : out.h == nullptr ? simd<formula_loop<gradient, Formula>>
                                         : simd<formula_loop<hessian, Formula>>;
    in_radial_blocks([&](const double* s, Index count, const RadialOutput& part) { loop(formula_, s, count, part); },
                     r2, n, out);
  }

 private:
  Formula formula_;
};

template <class Formula>
std::shared_ptr<const RadialFunction> make_radial_function(const Formula& formula) {
  return std::make_shared<FormulaFunction<Formula>>(formula);
}

}  // namespace csrbf
