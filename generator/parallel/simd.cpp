// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/parallel/simd.hpp"

#include <algorithm>

namespace heartgen::parallel {
namespace {

Simd best_level() {
#if HEARTGEN_HAS_VECTOR_VERSIONS
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return Simd::avx512;
  if (__builtin_cpu_supports("avx2")) return Simd::avx2;
#endif
  return Simd::plain;
}

Simd current = best_level();  // plain until then: the same bits

}  // namespace

Simd simd_level() { return current; }

Simd set_simd_level(Simd level) { return current = std::min(level, best_level()); }

const char* name_of(Simd level) {
  switch (level) {
    case Simd::avx512:
      return "AVX-512";
    case Simd::avx2:
      return "AVX2";
    case Simd::plain:
      break;
  }
  return "plain";
}

}  // namespace heartgen::parallel
