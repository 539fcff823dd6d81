#include "generator/parallel/threads.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace heart::parallel {
namespace {

thread_local bool inside_loop = false;

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

struct Loop {
  std::int64_t begin = 0, end = 0;
  int pieces = 1;
  LoopBody body{};
  std::vector<std::exception_ptr> errors;

  void run_piece(int piece) {
    const auto length = end - begin;
    inside_loop = true;
    try {
      body.call(body.object, begin + length * piece / pieces, begin + length * (piece + 1) / pieces, piece);
    } catch (...) {
      errors[static_cast<std::size_t>(piece)] = std::current_exception();
    }
    inside_loop = false;
  }
};

/// Waits a moment for what is about to happen: many loops are as short as it takes to wake a thread.
template <class Condition>
void wait_briefly(const Condition& is_over) {
  constexpr int looks = 2000;
  for (int i = 0; i < looks && !is_over(); ++i) pause();
}

/// Workers 1 .. count-1; the caller of run() does piece 0 itself.
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
      waiting_for = next.pieces - 1;
    }
    wake.notify_all();
    next.run_piece(0);
    wait_briefly([this] { return waiting_for == 0; });
    std::unique_lock lock(mutex);
    finished.wait(lock, [this] { return waiting_for == 0; });
    loop = nullptr;
  }

 private:
  void work(int worker) {
    std::uint64_t seen = 0;
    for (;;) {
      wait_briefly([&] { return turn != seen; });
      std::unique_lock lock(mutex);
      wake.wait(lock, [&] { return closing || (turn != seen && loop); });
      if (closing) return;
      seen = turn;
      if (worker >= loop->pieces) continue;
      Loop& current = *loop;
      lock.unlock();
      current.run_piece(worker);
      lock.lock();
      if (--waiting_for == 0) finished.notify_one();
    }
  }

  std::vector<std::thread> threads;
  std::mutex mutex;
  std::condition_variable wake, finished;
  Loop* loop = nullptr;
  std::atomic<std::uint64_t> turn = 0;  ///< changed under the lock; looked at without it
  std::atomic<int> waiting_for = 0;     ///< the same
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
  Loop loop{begin, end, static_cast<int>(pieces), body, std::vector<std::exception_ptr>(pieces)};
  state.pool->run(loop);
  for (const auto& error : loop.errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace heart::parallel
