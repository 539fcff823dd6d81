// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How long the parts of a stage took, for its log.
#pragma once
#include <chrono>
#include <string>
#include <vector>

namespace heartgen {

struct PartTime {
  std::string name;
  double seconds = 0;
};

struct PartClock {
  std::vector<PartTime> times{};
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();

  /// Notes the time since the part before it.
  void done(const char* name) {
    const auto now = std::chrono::steady_clock::now();
    times.push_back({name, std::chrono::duration<double>(now - start).count()});
    start = now;
  }
};

}  // namespace heartgen
