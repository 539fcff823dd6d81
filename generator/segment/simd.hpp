// Private to this folder and generator/contours: how inner loops are compiled. A loop is written once, as plain C++
// over the voxels of a row, and compiled for several vector lengths; the widest one that the machine has is chosen at
// run time.
//
// Every version does the same IEEE operations in the same order for each voxel (no fused multiply-add, no
// reassociation, no approximate instructions), so all give the same bits. Files with such loops are listed in
// CMakeLists.txt for the flags that let the vectoriser use square roots and selections.
#pragma once
#include <cstdint>

#define HEART_INLINE inline __attribute__((always_inline))
#define HEART_INLINE_LAMBDA __attribute__((always_inline))

/// Before a loop whose voxels do not depend on each other: pointers of a row may look as if they overlapped.
#if defined(__clang__)
#define HEART_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define HEART_INDEPENDENT _Pragma("GCC ivdep")
#endif

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define HEART_HAS_VECTOR_VERSIONS 1
#else
#define HEART_HAS_VECTOR_VERSIONS 0
#endif

namespace heart::segment {

enum class Simd { plain, avx2, avx512 };

/// What loops use from now on: the machine's best at the start.
Simd simd_level();

/// The best version that the machine has and that is not above `level`; used from now on and returned. All versions
/// give the same bits: this is for tests and measurements. Not to be called while a loop runs.
Simd set_simd_level(Simd level);

const char* name_of(Simd level);

#if HEART_HAS_VECTOR_VERSIONS
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
#if HEART_HAS_VECTOR_VERSIONS
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

/// Voxels that a block of a row has: the longest vector.
inline constexpr std::int64_t block = 16;

/// Calls at(i) for i in [0, n), in whole blocks for the vectoriser; the last block begins earlier where n is no
/// multiple of the block, so at(i) may be called twice and must not read what it writes.
template <class At>
HEART_INLINE void for_blocks(std::int64_t n, At&& at) {
  if (n < block) {
    for (std::int64_t i = 0; i < n; ++i) at(i);
    return;
  }
  for (std::int64_t begin = 0; begin < n; begin += block) {
    const auto first = begin < n - block ? begin : n - block;
    HEART_INDEPENDENT
    for (std::int64_t i = 0; i < block; ++i) at(first + i);
  }
}

/// Calls at(left, i, right) for the voxels of a row, the ends being their own neighbours.
template <class At>
HEART_INLINE void for_row(std::int64_t nx, At&& at) {
  const auto last = nx - 1;
  at(std::int64_t{0}, std::int64_t{0}, last > 0 ? std::int64_t{1} : std::int64_t{0});
  for_blocks(nx - 2, [&](std::int64_t i) HEART_INLINE_LAMBDA { at(i, i + 1, i + 2); });
  if (last > 0) at(last - 1, last, last);
}

HEART_INLINE float larger(float a, float b) { return a > b ? a : b; }
HEART_INLINE float smaller(float a, float b) { return a < b ? a : b; }
HEART_INLINE float square(float v) { return v * v; }

}  // namespace heart::segment
