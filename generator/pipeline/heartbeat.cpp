// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/heartbeat.hpp"

#include <utility>

namespace heartgen::pipeline {

Heartbeat::Heartbeat(std::chrono::milliseconds period, Tell tell)
    : thread_([this, period, tell = std::move(tell)] {
        const auto start = std::chrono::steady_clock::now();
        auto next = start + period;
        std::unique_lock lock(mutex_);
        for (; !wake_.wait_until(lock, next, [this] { return ended_; }); next += period)
          tell(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      }) {}

Heartbeat::~Heartbeat() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

}  // namespace heartgen::pipeline
