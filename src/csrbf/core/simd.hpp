#pragma once

#if defined(__GNUC__) || defined(__clang__)
#define CSRBF_ALWAYS_INLINE __attribute__((always_inline)) inline
#else
#define CSRBF_ALWAYS_INLINE inline
#endif

// Added to the instructions that the compiler was told to use.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(_WIN32)
#define CSRBF_HAS_AVX
#define CSRBF_AVX2 __attribute__((target("avx2,fma")))
#define CSRBF_AVX512 __attribute__((target("avx2,fma,avx512f,avx512bw,avx512dq,avx512vl")))
#endif

namespace csrbf {

/// Bytes of the vectors to use in functions that simd<> compiles.
#if defined(CSRBF_HAS_AVX) || defined(__AVX__)
inline constexpr int simd_vector_bytes = 32;
#else
inline constexpr int simd_vector_bytes = 16;
#endif

/// Bytes of the registers here that simd<> and simd_call() use: 64 with AVX-512, 32 with AVX2 + FMA, 16 elsewhere.
inline int simd_bytes() {
#if defined(CSRBF_HAS_AVX)
  static const int bytes = [] {
    if (__builtin_cpu_supports("avx2") == 0 || __builtin_cpu_supports("fma") == 0) return 16;
    const bool longest = __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
                         __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
    return longest ? 64 : 32;
  }();
  return bytes;
#else
  return 16;
#endif
}

namespace simd_versions {

template <auto function>
struct Of;

template <class Result, class... Parameters, Result (*function)(Parameters...)>
struct Of<function> {
#if defined(CSRBF_HAS_AVX)
  CSRBF_AVX512 static Result with_avx512(Parameters... values) {
    return function(values...);
  }
  CSRBF_AVX2 static Result with_avx2(Parameters... values) {
    return function(values...);
  }
  static Result best(Parameters... values) {
    const int bytes = simd_bytes();
    if (bytes == 64) return with_avx512(values...);
    if (bytes == 32) return with_avx2(values...);
    return function(values...);
  }
#else
  static Result best(Parameters... values) {
    return function(values...);
  }
#endif
};

#if defined(CSRBF_HAS_AVX)
template <class Kernel, int Bytes, class... Arguments>
CSRBF_AVX512 auto with_avx512(Arguments... arguments) {
  return Kernel::template run<Bytes>(arguments...);
}
template <class Kernel, class... Arguments>
CSRBF_AVX2 auto with_avx2(Arguments... arguments) {
  return Kernel::template run<32>(arguments...);
}
#endif

}  // namespace simd_versions

/// A pointer to `function`, which has long arithmetic loops and is marked CSRBF_ALWAYS_INLINE like all that it calls,
/// compiled three times: for any processor, AVX2 and AVX-512; each call takes the best that is here. Use it as
/// simd<function>(arguments...). Results may differ in the last bits from one processor to another, never from one
/// thread count to another.
template <auto function>
inline constexpr auto simd = &simd_versions::Of<function>::best;

/// Kernel::run<Bytes>(arguments...), a static function marked CSRBF_ALWAYS_INLINE that is written in Lanes, compiled
/// three times: for any processor (Bytes is 16), AVX2 (32) and AVX-512 (`Most`). As opposed to simd<> the kernel knows
/// the length of the registers.
template <class Kernel, int Most = 64, class... Arguments>
auto simd_call(Arguments... arguments) {
#if defined(CSRBF_HAS_AVX)
  const int bytes = simd_bytes();
  if (bytes == 64) return simd_versions::with_avx512<Kernel, Most>(arguments...);
  if (bytes == 32) return simd_versions::with_avx2<Kernel>(arguments...);
#endif
  return Kernel::template run<16>(arguments...);
}

}  // namespace csrbf
