#pragma once

#include "csrbf/core/sanitized.hpp"

#include <cstdlib>  // defines __GLIBC__ where the C library is glibc

/// CSRBF_SIMD_CLONES before a non-template function with long arithmetic loops compiles it three times, for plain
/// x86-64, AVX2 + FMA and AVX-512, and lets the program loader choose. Templates called from it take part when they are
/// marked CSRBF_ALWAYS_INLINE. Results may differ in the last bits from one processor to another, never from one thread
/// count to another.
///
/// Empty where the mechanism (GNU indirect functions) is missing, where the compiler was told to use AVX-512
/// everywhere, and under sanitizers, whose runtime is not ready when the loader runs the selectors.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && __GNUC__ >= 12 && !defined(__clang__) && \
    !defined(__AVX512F__) && !defined(CSRBF_SANITIZED)
#define CSRBF_SIMD_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define CSRBF_SIMD_CLONES
#endif

/// CSRBF_SIMD_WIDE compiles a function for AVX-512 alone, to be called where has_wide_simd(), for loops that want to be
/// written otherwise for its 32 registers of eight doubles. Empty but for GCC 12 and later. It adds to the instructions
/// that the compiler was told to use: those of functions that are inlined must be among them.
#if defined(__x86_64__) && defined(__GNUC__) && __GNUC__ >= 12 && !defined(__clang__) && !defined(__AVX512F__) && \
    !defined(_WIN32)
#define CSRBF_SIMD_WIDE __attribute__((target("avx512f,avx512bw,avx512cd,avx512dq,avx512vl,fma,bmi,bmi2,lzcnt,movbe")))
#define CSRBF_HAS_WIDE_SIMD
#else
#define CSRBF_SIMD_WIDE
#endif

#if defined(__GNUC__) || defined(__clang__)
#define CSRBF_ALWAYS_INLINE __attribute__((always_inline)) inline
#else
#define CSRBF_ALWAYS_INLINE inline
#endif

namespace csrbf {

/// Whether functions marked CSRBF_SIMD_WIDE run here, and are for AVX-512.
inline bool has_wide_simd() {
#if defined(CSRBF_HAS_WIDE_SIMD)
  return __builtin_cpu_supports("x86-64-v4") != 0;
#else
  return false;
#endif
}

}  // namespace csrbf
