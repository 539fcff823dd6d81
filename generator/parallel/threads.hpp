// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Threads inside one process: a persistent pool and loops cut into contiguous pieces and parts of these.
/// What is computed must not depend on where they begin and end; then results have the same bits for any
/// number of threads. For sums use `sum_rows` (slab.hpp) or one number per index added afterwards in index order.
#pragma once
#include <cstdint>
#include <type_traits>

namespace heartgen::parallel {

/// Threads that parallel_for uses from now on, at least 1. Not to be called from inside a loop.
void set_thread_count(int count);

/// Defaults to the number of hardware threads.
int thread_count();

/// A loop body for the pool: called with [begin, end) and the number of the piece, 0 to thread_count()-1.
struct LoopBody {
  bool is_divisible;  ///< may be called several times for a piece, for parts of it
  void* object;
  void (*call)(void* object, std::int64_t begin, std::int64_t end, int piece);
};

void run_loop(std::int64_t begin, std::int64_t end, const LoopBody& body);

/// Calls body(begin, end, piece) on up to thread_count() contiguous pieces of [begin, end), once for each, or
/// body(begin, end) on parts of these, and waits for all. Threads that are done with their own piece help with the
/// others. Loops inside loops run on the calling thread. An exception of the first part that fails is rethrown.
template <class Body>
void parallel_for(std::int64_t begin, std::int64_t end, Body&& body) {
  using Plain = std::remove_reference_t<Body>;
  constexpr bool takes_piece = std::is_invocable_v<Plain&, std::int64_t, std::int64_t, int>;
  run_loop(begin, end,
           {!takes_piece, const_cast<void*>(static_cast<const void*>(&body)),
            [](void* object, std::int64_t from, std::int64_t to, int piece) {
              auto& callable = *static_cast<Plain*>(object);
              if constexpr (takes_piece)
                callable(from, to, piece);
              else
                callable(from, to);
            }});
}

}  // namespace heartgen::parallel
