// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A sign of life from work that says nothing itself.
#pragma once
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace heartgen::pipeline {

/// While it lives, another thread calls `tell` with the seconds since its beginning, every `period`. `tell` must not
/// touch what the work changes.
struct Heartbeat {
  using Tell = std::function<void(double seconds)>;
  Heartbeat(std::chrono::milliseconds period, Tell tell);
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ended_ = false;
  std::thread thread_;  // last: it uses the others
};

/// How long the plain lines of a long work may be apart.
inline constexpr std::chrono::milliseconds longest_silence{10'000};

}  // namespace heartgen::pipeline
