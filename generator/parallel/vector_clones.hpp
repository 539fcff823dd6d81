// For functions that are compiled once for every x86-64 and once for AVX2, chosen at start-up; both give the same bits
// where the order of operations is written down. The sanitizers do not get along with the load-time choice.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define HEART_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define HEART_VECTOR_CLONES
#endif
