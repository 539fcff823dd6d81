// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/unfinished.hpp"

#include <mutex>
#include <set>

namespace heartgen {
namespace {

namespace fs = std::filesystem;

// Never destroyed: a signal may come while the program ends.
struct Unfinished {
  std::mutex mutex;
  std::set<fs::path> paths;
};

Unfinished& unfinished() {
  static auto* const all = new Unfinished;
  return *all;
}

}  // namespace

void note_unfinished(const fs::path& path) {
  const std::lock_guard lock(unfinished().mutex);
  unfinished().paths.insert(path);
}

void forget_unfinished(const fs::path& path) {
  const std::lock_guard lock(unfinished().mutex);
  unfinished().paths.erase(path);
}

void remove_unfinished() {
  unfinished().mutex.lock();      // and kept
  constexpr int max_tries = 100;  // other threads may be making their last files in a folder
  for (const auto& path : unfinished().paths) {
    std::error_code error;
    for (int tries = 0; tries < max_tries && fs::exists(fs::symlink_status(path, error)); ++tries)
      fs::remove_all(path, error);
  }
}

void wait_where_stopped() { const std::lock_guard lock(unfinished().mutex); }

}  // namespace heartgen
