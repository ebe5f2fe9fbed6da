// SPDX-License-Identifier: Apache-2.0
// The vector instructions that the types of this folder are made of: those of x86-64-v3 where a file is
// compiled for them, else the functions of the same names that SIMDe makes of what there is on any processor.
// Both give the same bits. SIMDe rounds twice where FMA rounds once, so that the fused operations are here.
#pragma once

#ifdef __AVX2__

#include <immintrin.h>

namespace tessera::core {

// a * b + c, a * b - c and c - a * b in each lane, rounded once.
inline __m256 fused_multiply_add(__m256 a, __m256 b, __m256 c) {
  return _mm256_fmadd_ps(a, b, c);
}
inline __m256 fused_multiply_subtract(__m256 a, __m256 b, __m256 c) {
  return _mm256_fmsub_ps(a, b, c);
}
inline __m256 fused_negative_multiply_add(__m256 a, __m256 b, __m256 c) {
  return _mm256_fnmadd_ps(a, b, c);
}
inline __m256d fused_multiply_subtract(__m256d a, __m256d b, __m256d c) {
  return _mm256_fmsub_pd(a, b, c);
}
inline __m256d fused_negative_multiply_add(__m256d a, __m256d b, __m256d c) {
  return _mm256_fnmadd_pd(a, b, c);
}

}  // namespace tessera::core

#else

#define SIMDE_ENABLE_NATIVE_ALIASES
#include <simde/x86/avx2.h>

#include <cmath>
#include <cstddef>

namespace tessera::core {

template <typename Number, typename Vector>
Vector fused_in_each_lane(Vector a, Vector b, Vector c, Number sign_of_a, Number sign_of_c) {
  constexpr std::size_t kCount = sizeof(Vector) / sizeof(Number);
  Number a_of[kCount], b_of[kCount], c_of[kCount];
  __builtin_memcpy(a_of, &a, sizeof a);
  __builtin_memcpy(b_of, &b, sizeof b);
  __builtin_memcpy(c_of, &c, sizeof c);
  for (std::size_t i = 0; i < kCount; ++i)
    c_of[i] = std::fma(sign_of_a * a_of[i], b_of[i], sign_of_c * c_of[i]);
  __builtin_memcpy(&c, c_of, sizeof c);
  return c;
}
inline __m256 fused_multiply_add(__m256 a, __m256 b, __m256 c) {
  return fused_in_each_lane(a, b, c, 1.0f, 1.0f);
}
inline __m256 fused_multiply_subtract(__m256 a, __m256 b, __m256 c) {
  return fused_in_each_lane(a, b, c, 1.0f, -1.0f);
}
inline __m256 fused_negative_multiply_add(__m256 a, __m256 b, __m256 c) {
  return fused_in_each_lane(a, b, c, -1.0f, 1.0f);
}
inline __m256d fused_multiply_subtract(__m256d a, __m256d b, __m256d c) {
  return fused_in_each_lane(a, b, c, 1.0, -1.0);
}
inline __m256d fused_negative_multiply_add(__m256d a, __m256d b, __m256d c) {
  return fused_in_each_lane(a, b, c, -1.0, 1.0);
}

}  // namespace tessera::core

#endif
