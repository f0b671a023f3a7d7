#pragma once

#include <cstdlib>  // defines __GLIBC__ where the C library is glibc

/// CSRBF_SANITIZED is defined when compiling with a sanitizer of memory or threads.
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define CSRBF_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CSRBF_SANITIZED
#endif

/// CSRBF_SIMD_CLONES before a non-template function with long arithmetic loops compiles it three times, for plain
/// x86-64, AVX2 + FMA and AVX-512, and lets the program loader choose. Templates called from it take part when they are
/// marked CSRBF_ALWAYS_INLINE. Results may differ in the last bits from one processor to another, never from one thread
/// count to another.
///
/// Empty where the mechanism (GNU indirect functions) is missing or other files cannot call the function (clang), where
/// the compiler was told to use AVX-512 everywhere, and under sanitizers, whose runtime is not ready when the loader
/// runs the selectors. Loops written in Lanes had better be called by simd_call(), which does without.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && __GNUC__ >= 12 && !defined(__clang__) && \
    !defined(__AVX512F__) && !defined(CSRBF_SANITIZED)
#define CSRBF_HAS_CLONES
#define CSRBF_SIMD_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define CSRBF_SIMD_CLONES
#endif

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

/// Bytes of the vectors to use in functions marked CSRBF_SIMD_CLONES.
#if defined(CSRBF_HAS_CLONES) || defined(__AVX__)
inline constexpr int simd_clone_bytes = 32;
#else
inline constexpr int simd_clone_bytes = 16;
#endif

/// Bytes of the registers here that simd_call() uses: 64 with AVX-512, 32 with AVX2 + FMA, 16 elsewhere.
inline int simd_bytes() {
#if defined(CSRBF_HAS_AVX)
  if (__builtin_cpu_supports("avx2") == 0 || __builtin_cpu_supports("fma") == 0) return 16;
  const bool longest = __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
                       __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
  return longest ? 64 : 32;
#else
  return 16;
#endif
}

#if defined(CSRBF_HAS_AVX)
namespace simd {

template <class Kernel, int Bytes, class... Arguments>
CSRBF_AVX512 auto with_avx512(Arguments... arguments) {
  return Kernel::template run<Bytes>(arguments...);
}
template <class Kernel, class... Arguments>
CSRBF_AVX2 auto with_avx2(Arguments... arguments) {
  return Kernel::template run<32>(arguments...);
}

}  // namespace simd
#endif

/// Kernel::run<Bytes>(arguments...), a static function marked CSRBF_ALWAYS_INLINE that is written in Lanes, compiled
/// three times: for any processor (Bytes is 16), AVX2 (32) and AVX-512 (`Most`). As opposed to CSRBF_SIMD_CLONES the
/// kernel knows the length of the registers and may be a template, and any compiler and loader will do.
template <class Kernel, int Most = 64, class... Arguments>
auto simd_call(Arguments... arguments) {
#if defined(CSRBF_HAS_AVX)
  const int bytes = simd_bytes();
  if (bytes == 64) return simd::with_avx512<Kernel, Most>(arguments...);
  if (bytes == 32) return simd::with_avx2<Kernel>(arguments...);
#endif
  return Kernel::template run<16>(arguments...);
}

}  // namespace csrbf
