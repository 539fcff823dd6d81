// Threads inside one process: a persistent pool and loops cut into contiguous pieces.
// What a piece computes must not depend on where the pieces begin and end; then results have the same bits for any
// number of threads. For sums use `sum_rows` (slab.hpp) or one number per index added afterwards in index order.
#pragma once
#include <cstdint>
#include <type_traits>

namespace heart::parallel {

/// Threads that parallel_for uses from now on, at least 1. Not to be called from inside a loop.
void set_thread_count(int count);

/// Defaults to the number of hardware threads.
int thread_count();

/// A loop body for the pool: called with [begin, end) of one piece and the number of the piece, 0 to thread_count()-1.
struct LoopBody {
  void* object;
  void (*call)(void* object, std::int64_t begin, std::int64_t end, int piece);
};

void run_loop(std::int64_t begin, std::int64_t end, const LoopBody& body);

/// Calls body(begin, end) or body(begin, end, piece) on up to thread_count() contiguous pieces of [begin, end) and
/// waits for all. Loops inside loops run on the calling thread. An exception of the first failing piece is rethrown.
template <class Body>
void parallel_for(std::int64_t begin, std::int64_t end, Body&& body) {
  using Plain = std::remove_reference_t<Body>;
  run_loop(begin, end,
           {const_cast<void*>(static_cast<const void*>(&body)),
            [](void* object, std::int64_t from, std::int64_t to, int piece) {
              auto& callable = *static_cast<Plain*>(object);
              if constexpr (std::is_invocable_v<Plain&, std::int64_t, std::int64_t, int>)
                callable(from, to, piece);
              else
                callable(from, to);
            }});
}

}  // namespace heart::parallel
