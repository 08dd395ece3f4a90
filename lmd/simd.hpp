// SPDX-License-Identifier: Apache-2.0
// Four floats side by side: the compiler's vector types, and the two operations it has no operator for.
#pragma once

#ifdef __SSE2__
#include <emmintrin.h>
#else
#include <cmath>
#endif

// Always inlined, so compiled with the instructions that the caller may use.
#define AUSSOIS_INLINE inline __attribute__((always_inline))

// Marks the second version of a function, for machines with more than SSE2; chosen when it is called.
#if defined(__x86_64__)
#define AUSSOIS_AVX2 __attribute__((target("avx2")))
#else
#define AUSSOIS_AVX2
#endif

namespace aussois {

using F4 = float __attribute__((vector_size(16)));
using I4 = int __attribute__((vector_size(16)));  // result of a comparison: -1 or 0 per lane

AUSSOIS_INLINE F4 splat(float x) {
  return F4{x, x, x, x};
}

AUSSOIS_INLINE F4 load4(const float* x) {
#ifdef __SSE2__
  return _mm_load_ps(x);  // aligned
#else
  return F4{x[0], x[1], x[2], x[3]};
#endif
}

AUSSOIS_INLINE void store4(F4 x, float (&to)[4]) {
  __builtin_memcpy(to, &x, sizeof x);
}

AUSSOIS_INLINE F4 sqrt4(F4 x) {
#ifdef __SSE2__
  return _mm_sqrt_ps(x);
#else
  return F4{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
#endif
}

/// Bit i is set if lane i is true.
AUSSOIS_INLINE int bits(I4 m) {
#ifdef __SSE2__
  return _mm_movemask_ps(__m128(m));
#else
  return (m[0] & 1) | (m[1] & 2) | (m[2] & 4) | (m[3] & 8);
#endif
}

AUSSOIS_INLINE F4 abs4(F4 x) {
  return F4(I4(x) & 0x7fffffff);  // all but the sign
}

AUSSOIS_INLINE F4 min4(F4 a, F4 b) {
  return a < b ? a : b;
}

AUSSOIS_INLINE F4 max4(F4 a, F4 b) {
  return a > b ? a : b;
}

/// Whether this machine has AVX2.
inline bool has_avx2() {
#if defined(__x86_64__)
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
#else
  return false;
#endif
}

struct V4 {  // four vectors
  F4 x, y, z;
};

AUSSOIS_INLINE V4 operator-(const V4& a, const V4& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
AUSSOIS_INLINE V4 operator+(const V4& a, const V4& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
AUSSOIS_INLINE V4 operator*(F4 s, const V4& a) {
  return {s * a.x, s * a.y, s * a.z};
}
AUSSOIS_INLINE F4 dot(const V4& a, const V4& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
AUSSOIS_INLINE V4 cross(const V4& a, const V4& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// The vector of one lane, in all lanes.
AUSSOIS_INLINE V4 spread(const V4& a, int lane) {
  return {splat(a.x[lane]), splat(a.y[lane]), splat(a.z[lane])};
}
AUSSOIS_INLINE V4 load4(const float (&v)[3][4]) {
  return {load4(v[0]), load4(v[1]), load4(v[2])};
}
AUSSOIS_INLINE V4 spread(const float (&v)[3][4], int lane) {
  return {splat(v[0][lane]), splat(v[1][lane]), splat(v[2][lane])};
}

}  // namespace aussois
