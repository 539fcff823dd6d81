// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/parallel/threads.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace heartgen::parallel {
namespace {

thread_local bool inside_loop = false;

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

/// A range cut into a piece for each thread and each piece into parts, large ones first. A thread does the parts of its
/// own piece, then those of the others that nobody has begun: what takes longer in one half than in the other keeps
/// nobody waiting.
struct Loop {
  Loop(std::int64_t first, std::int64_t last, int piece_count, const LoopBody& loop_body)
      : begin(first), end(last), pieces(piece_count), parts(loop_body.is_divisible ? max_parts : 1), body(loop_body) {
    begun = std::vector<std::atomic<int>>(static_cast<std::size_t>(pieces));
    errors.resize(static_cast<std::size_t>(pieces) * static_cast<std::size_t>(parts));
  }

  void work(int worker) {
    inside_loop = true;
    for (int other = 0; other < pieces; ++other) {
      const int piece = (worker + other) % pieces;
      auto& next = begun[static_cast<std::size_t>(piece)];
      for (int part = next++; part < parts; part = next++) run_part(piece, part);
    }
    inside_loop = false;
  }

  static constexpr int max_parts = 4;
  std::int64_t begin = 0, end = 0;
  int pieces = 1, parts = 1;
  LoopBody body{};
  std::vector<std::atomic<int>> begun;     ///< parts of each piece
  std::vector<std::exception_ptr> errors;  ///< of each part

 private:
  // A half, a quarter, an eighth and the last eighth of the piece.
  std::int64_t begin_of_part(int piece, int part) const {
    const auto from = begin + (end - begin) * piece / pieces, to = begin + (end - begin) * (piece + 1) / pieces;
    return part == parts ? to : to - ((to - from) >> part);
  }

  void run_part(int piece, int part) {
    const auto from = begin_of_part(piece, part), to = begin_of_part(piece, part + 1);
    if (from == to) return;
    try {
      body.call(body.object, from, to, piece);
    } catch (...) {
      errors[static_cast<std::size_t>(piece) * static_cast<std::size_t>(parts) + static_cast<std::size_t>(part)] =
          std::current_exception();
    }
  }
};

/// Waits a moment for what is about to happen: many loops are as short as it takes to wake a thread.
template <class Condition>
void wait_briefly(const Condition& is_over) {
  constexpr int looks = 2000;
  for (int i = 0; i < looks && !is_over(); ++i) pause();
}

/// Workers 1 .. count-1; the caller of run() is number 0. Who wakes up too late finds nothing left.
struct Pool {
  explicit Pool(int count) {
    for (int worker = 1; worker < count; ++worker) threads.emplace_back([this, worker] { work(worker); });
  }
  ~Pool() {
    {
      const std::lock_guard lock(mutex);
      closing = true;
    }
    wake.notify_all();
    for (auto& thread : threads) thread.join();
  }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  int size() const { return static_cast<int>(threads.size()) + 1; }

  void run(Loop& next) {
    {
      const std::lock_guard lock(mutex);
      loop = &next;
      ++turn;
    }
    wake.notify_all();
    next.work(0);
    std::unique_lock lock(mutex);
    loop = nullptr;
    lock.unlock();
    wait_briefly([this] { return at_work == 0; });
    lock.lock();
    finished.wait(lock, [this] { return at_work == 0; });
  }

 private:
  void work(int worker) {
    std::uint64_t seen = 0;
    for (;;) {
      wait_briefly([&] { return turn != seen; });
      std::unique_lock lock(mutex);
      wake.wait(lock, [&] { return closing || turn != seen; });
      if (closing) return;
      seen = turn;
      if (loop == nullptr || worker >= loop->pieces) continue;
      Loop& current = *loop;
      ++at_work;
      lock.unlock();
      current.work(worker);
      lock.lock();
      if (--at_work == 0) finished.notify_one();
    }
  }

  std::vector<std::thread> threads;
  std::mutex mutex;
  std::condition_variable wake, finished;
  Loop* loop = nullptr;
  std::atomic<std::uint64_t> turn = 0;  ///< changed under the lock; looked at without it
  std::atomic<int> at_work = 0;         ///< workers; the same
  bool closing = false;
};

struct Shared {
  std::mutex in_use;  ///< one loop at a time; loops started meanwhile by other threads run on those threads
  std::atomic<int> count = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));  ///< readable in a loop
  std::unique_ptr<Pool> pool;
};

Shared& shared() {
  static Shared instance;
  return instance;
}

}  // namespace

void set_thread_count(int count) {
  const std::lock_guard lock(shared().in_use);
  shared().count = std::max(1, count);
}

int thread_count() { return shared().count; }

void run_loop(std::int64_t begin, std::int64_t end, const LoopBody& body) {
  if (begin >= end) return;
  auto& state = shared();
  std::unique_lock lock(state.in_use, std::defer_lock);
  const bool alone = !inside_loop && lock.try_lock();
  const int count = state.count;
  const auto pieces = alone ? std::min<std::int64_t>(count, end - begin) : 1;
  if (pieces == 1) {
    if (alone) lock.unlock();
    body.call(body.object, begin, end, 0);
    return;
  }
  if (!state.pool || state.pool->size() != count) {
    state.pool.reset();
    state.pool = std::make_unique<Pool>(count);
  }
  Loop loop(begin, end, static_cast<int>(pieces), body);
  state.pool->run(loop);
  for (const auto& error : loop.errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace heartgen::parallel
