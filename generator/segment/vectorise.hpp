// Private to this folder: how inner loops are compiled. Files that use it are listed in CMakeLists.txt.
#pragma once

// One copy for every x86-64 and one for AVX2, chosen at start-up; both give the same bits. The sanitizers do not get
// along with the load-time choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define HEART_VECTOR __attribute__((target_clones("avx2", "default")))
#else
#define HEART_VECTOR
#endif
#define HEART_INLINE inline __attribute__((always_inline))

namespace heart::segment {

HEART_INLINE float larger(float a, float b) { return a > b ? a : b; }
HEART_INLINE float smaller(float a, float b) { return a < b ? a : b; }

}  // namespace heart::segment
