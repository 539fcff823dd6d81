// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How inner loops are compiled: written once, as plain C++, and compiled for several vector lengths; the widest one
/// that the machine has is chosen at run time.
///
/// Every version does the same IEEE operations in the same order for each element (no fused multiply-add, no
/// reassociation, no approximate instructions), so all give the same bits. Files with such loops are listed in
/// cmake/rooms.cmake for the flags that let the vectoriser use square roots and selections.
#pragma once
#include <cstdint>

#define HEARTGEN_INLINE inline __attribute__((always_inline))
#define HEARTGEN_INLINE_LAMBDA __attribute__((always_inline))

/// Before a loop whose voxels do not depend on each other: pointers of a row may look as if they overlapped.
#if defined(__clang__)
#define HEARTGEN_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define HEARTGEN_INDEPENDENT _Pragma("GCC ivdep")
#endif

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define HEARTGEN_HAS_VECTOR_VERSIONS 1
#else
#define HEARTGEN_HAS_VECTOR_VERSIONS 0
#endif

namespace heartgen::parallel {

enum class Simd { plain, avx2, avx512 };

/// What loops use from now on: the machine's best at the start.
Simd simd_level();

/// The best version that the machine has and that is not above `level`; used from now on and returned. All versions
/// give the same bits: this is for tests and measurements. Not to be called while a loop runs.
Simd set_simd_level(Simd level);

const char* name_of(Simd level);

#if HEARTGEN_HAS_VECTOR_VERSIONS
template <auto body, class... Args>
__attribute__((target("avx2"))) void on_avx2(const Args&... args) {
  body(args...);
}
template <auto body, class... Args>
__attribute__((target("avx2,avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width=512"))) void on_avx512(
    const Args&... args) {
  body(args...);
}
#endif

/// Runs body(args...), an always-inline function, in the version that simd_level() names.
template <auto body, class... Args>
void vectorised(const Args&... args) {
#if HEARTGEN_HAS_VECTOR_VERSIONS
  switch (simd_level()) {
    case Simd::avx512:
      return on_avx512<body>(args...);
    case Simd::avx2:
      return on_avx2<body>(args...);
    case Simd::plain:
      break;
  }
#endif
  body(args...);
}

}  // namespace heartgen::parallel
