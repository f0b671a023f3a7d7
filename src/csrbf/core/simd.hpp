#pragma once

#include "csrbf/core/sanitized.hpp"

#include <cstdlib>  // defines __GLIBC__ where the C library is glibc

/// CSRBF_SIMD_CLONES before a non-template function with long arithmetic loops compiles it three times, for plain
/// x86-64, AVX2 + FMA and AVX-512, and lets the program loader choose. Templates called from it take part when they are
/// marked CSRBF_ALWAYS_INLINE. Results may differ in the last bits from one processor to another, never from one thread
/// count to another.
///
/// Empty where the mechanism (GNU indirect functions) is missing, and under sanitizers, whose runtime is not ready when
/// the loader runs the selectors.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && __GNUC__ >= 12 && !defined(__clang__) && \
    !defined(CSRBF_SANITIZED)
#define CSRBF_SIMD_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define CSRBF_SIMD_CLONES
#endif

#if defined(__GNUC__) || defined(__clang__)
#define CSRBF_ALWAYS_INLINE __attribute__((always_inline)) inline
#else
#define CSRBF_ALWAYS_INLINE inline
#endif
